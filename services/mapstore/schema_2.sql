-- SPDX-License-Identifier: Apache-2.0
-- What version 2 of a kinemap map adds to schema.sql.

CREATE TABLE dense_keyframes (          -- semi-dense maps; the points as little-endian arrays
    keyframe_id INTEGER PRIMARY KEY,
    points INTEGER NOT NULL,
    position BLOB NOT NULL,             -- float32 [points, 3] in the keyframe's camera frame
    depth_sigma BLOB NOT NULL,          -- float32 [points]
    grey BLOB NOT NULL,                 -- uint8 [points]
    state BLOB NOT NULL,                -- uint8 [points] MotionState
    category BLOB NOT NULL,             -- int16 [points] COCO category, -1: none
    object_id BLOB NOT NULL             -- uint32 [points] 0: none
);
