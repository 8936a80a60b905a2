# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset labelme`: LabelMe's polygons as masks."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from schemas.categories import is_category
from services.cli.evaluate.progress import bar
from services.cli.thesis.output import out_folder
from services.runtime.errors import InputError

if TYPE_CHECKING:
    from services.evaluation.thesis.drawn_objects import DrawnLabel

NAME = "labelme"
OBJECTS, MOVERS, COMBINED, INSTANCES = "objects", "movers", "moving", "instances"
_SHOWN = 255
_MOTIONS = {"moving": True, "static": False}
_IGNORED = "ignore"


def labelme(
    given: Annotated[Path, typer.Argument(metavar="JSON_OR_FOLDER", help="LabelMe's file, or a folder of them.")],
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the masks.")],
    label: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=CATEGORY:moving|static",
            help="What a label means, COCO's category and whether it moves, or NAME=ignore; repeatable (known are "
            "static_car and moving_car).",
        ),
    ] = None,
) -> None:
    """Write polygons as masks: objects/ all (0, 255), movers/ those that move (0, 255), moving/ both (0 background,
    1 stands, 2 moves), instances/ one value an object, with instances.json.

    Masks are named as the images are. Shapes of one label and group id are one object; where shapes overlap the later
    one is in front. `kinemap evaluate moving` and `kinemap run --instances` read what is written.
    """
    from services.evaluation.moving_masks.iou import MaskClass
    from services.evaluation.run.report import write_report
    from services.evaluation.thesis.drawn_objects import THESIS_LABELS, draw_objects
    from services.formats.label_images import write_label_image, write_label_index
    from services.formats.labelme import read_labelme
    from services.formats.png import write_png

    meanings = {**THESIS_LABELS, **dict(map(parse_label, label or ()))}
    files = _files(given)
    target = out_folder(out)
    folders = {name: out_folder(target / name) for name in (OBJECTS, MOVERS, COMBINED, INSTANCES)}
    index = {}
    for file in bar(files, "drawing masks"):
        image = read_labelme(file)
        if image.name in index:
            raise InputError(f"{file}: a second file for image {image.name}, expected one an image")
        try:
            drawn = draw_objects(image, meanings)
        except InputError as error:
            raise InputError(f"{file}: {error}") from None
        classes = drawn.classes
        write_png(folders[OBJECTS] / f"{image.name}.png", (classes > 0).astype(classes.dtype) * _SHOWN)
        write_png(folders[MOVERS] / f"{image.name}.png", (classes == MaskClass.MOVING).astype(classes.dtype) * _SHOWN)
        write_png(folders[COMBINED] / f"{image.name}.png", classes)
        write_label_image(folders[INSTANCES] / f"{image.name}.png", drawn.labels)
        index[image.name] = drawn.instances
    write_label_index(folders[INSTANCES], index)
    counts: dict[str, int] = {}
    for instance in (item for items in index.values() for item in items):
        kind = f"{'moving' if instance.moving else 'static'} {instance.category}"
        counts[kind] = counts.get(kind, 0) + 1
    write_report({"images": len(index), "objects": counts}, target / f"{NAME}.json")
    found = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items())) or "no objects"
    print(f"{len(index)} images, {found}")
    print(f"folder {target}")


def parse_label(text: str) -> "tuple[str, DrawnLabel | None]":
    """A label and what it means, of `NAME=CATEGORY:moving|static` or `NAME=ignore`. Raises InputError for others."""
    from services.evaluation.thesis.drawn_objects import DrawnLabel

    name, equals, meaning = text.partition("=")
    category, _, motion = meaning.partition(":")
    if name and equals and meaning == _IGNORED:
        return name, None
    if not (name and equals and motion in _MOTIONS and is_category(category)):
        raise InputError(
            f"--label {text}: expected NAME=CATEGORY:moving|static with COCO's category, or NAME={_IGNORED}"
        )
    return name, DrawnLabel(category, _MOTIONS[motion])


def _files(given: Path) -> list[Path]:
    if given.is_file():
        return [given]
    if not given.is_dir():
        raise InputError(f"{given}: no such file or folder, expected LabelMe's JSON")
    files = sorted(given.glob("*.json"))
    if not files:
        raise InputError(f"{given}: no JSON files, expected LabelMe's, one an image")
    return files
