-- SPDX-License-Identifier: Apache-2.0
-- A kinemap map, version 1; schema_2.sql is what version 2 adds. `PRAGMA application_id` is 0x4B4D4150 ("KMAP"), `PRAGMA user_version` is this version.
-- Lengths are in metres where progress.metric_scale is 1, in map units otherwise; times are the images' capture times.

CREATE TABLE progress (
    only_row INTEGER PRIMARY KEY CHECK (only_row = 1),
    session TEXT NOT NULL,
    sequence INTEGER NOT NULL,          -- the last frame whose transaction went through
    timestamp_ns INTEGER NOT NULL,
    map_id INTEGER NOT NULL,
    metric_scale INTEGER NOT NULL
);

CREATE TABLE keyframes (
    id INTEGER PRIMARY KEY,
    timestamp_ns INTEGER NOT NULL,
    map_id INTEGER NOT NULL,
    tx REAL, ty REAL, tz REAL,          -- Sim(3) map_from_keyframe
    qx REAL, qy REAL, qz REAL, qw REAL,
    scale REAL,
    culled INTEGER NOT NULL,            -- 1: a pose-only node
    parent_id INTEGER NOT NULL          -- -1: none
);

CREATE TABLE landmarks (
    id INTEGER PRIMARY KEY,
    anchor_id INTEGER NOT NULL,         -- the keyframe in whose camera frame x, y, z are
    x REAL, y REAL, z REAL,
    state INTEGER NOT NULL,             -- MotionState
    category INTEGER NOT NULL,          -- COCO category, -1: none
    object_id INTEGER NOT NULL,         -- 0: none
    first_seen_ns INTEGER NOT NULL,
    last_seen_ns INTEGER NOT NULL,
    valid_until_ns INTEGER NOT NULL     -- -1: still valid
);

CREATE TABLE removed_landmarks (        -- tombstones
    id INTEGER PRIMARY KEY,
    sequence INTEGER NOT NULL           -- the frame that removed it
);

CREATE TRIGGER landmark_came_back AFTER INSERT ON landmarks BEGIN
    DELETE FROM removed_landmarks WHERE id = NEW.id;
END;

CREATE TABLE frames (
    sequence INTEGER PRIMARY KEY,
    timestamp_ns INTEGER NOT NULL,
    state INTEGER NOT NULL,             -- TrackingState
    reason TEXT NOT NULL,
    handling TEXT NOT NULL,
    map_id INTEGER NOT NULL,
    reference_keyframe_id INTEGER NOT NULL,                 -- -1: no pose
    ref_tx REAL, ref_ty REAL, ref_tz REAL,                  -- camera_from_reference, which outlives map corrections
    ref_qx REAL, ref_qy REAL, ref_qz REAL, ref_qw REAL,
    live_tx REAL, live_ty REAL, live_tz REAL,               -- map_from_camera as it was known at the time
    live_qx REAL, live_qy REAL, live_qz REAL, live_qw REAL
);
CREATE INDEX frames_by_time ON frames (timestamp_ns, sequence);

CREATE TABLE densities (                -- what was answered for each frame
    sequence INTEGER PRIMARY KEY,
    x REAL, y REAL, z REAL,             -- NULL: no pose
    radius REAL NOT NULL,
    window_s REAL,                      -- NULL: ever
    moving_points INTEGER NOT NULL,
    moving_objects INTEGER NOT NULL,
    observed_points INTEGER NOT NULL,
    level INTEGER NOT NULL,             -- DensityLevel
    metric_scale INTEGER NOT NULL
);
