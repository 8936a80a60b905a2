# SPDX-License-Identifier: Apache-2.0
"""`kinemap train segmenter`: SOLOv2 on the user's own data or on simulated scenes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast, get_args

import typer
from rich.console import Console
from rich.progress import Progress

from services.cli.train.training_data import parse_training_data, read_samples
from services.runtime.errors import InputError

if TYPE_CHECKING:
    import torch

    from services.cli.train.segmenter_validation import Validation
    from services.segmenter.training.trainer import StepReport, Trainer

MODEL_NAME, CURVES_NAME = "model.safetensors", "curves.png"
_MULTIPLE_PX = 32
_CATEGORIES = ("person", "bicycle", "car", "motorcycle", "bus", "train", "truck")
"""What a drive meets."""
_SIZES = ("832x256", "832x448", "608x448")


def segmenter(
    data: Annotated[
        list[str],
        typer.Argument(metavar="DATA...", help="Folders of `kinemap train scenes`, FILE.json or FILE.json=IMAGES."),
    ],
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the result; a begun training goes on in it.")],
    validate: Annotated[
        list[str] | None, typer.Option(metavar="DATA", help="Judge by these at every save; may be repeated.")
    ] = None,
    category: Annotated[
        list[str] | None, typer.Option(help=f"What to learn; may be repeated (default: {', '.join(_CATEGORIES)}).")
    ] = None,
    variant: Annotated[str, typer.Option(help="The network; see `kinemap weights list`.")] = "solov2-compact_lite0",
    start_from: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Begin with these weights (same variant and categories).")
    ] = None,
    backbone: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Begin with this backbone learned at ImageNet (.pth of torchvision's ResNet or EfficientNet-Lite0).",
        ),
    ] = None,
    size: Annotated[
        list[str] | None,
        typer.Option(
            metavar="WIDTHxHEIGHT",
            help=(
                "Of a training image, multiples of 32; of several, a batch has the one most like its images "
                f"(default: {', '.join(_SIZES)})."
            ),
        ),
    ] = None,
    steps: Annotated[int, typer.Option(min=1, help="Batches to learn from; may be more when it goes on.")] = 20_000,
    warm_up: Annotated[
        int | None, typer.Option(min=0, help="First steps, over which the rate rises (default: a tenth, 1000 at most).")
    ] = None,
    cool_down: Annotated[
        int | None, typer.Option(min=0, help="Last steps, over which the rate falls (default: a fifth of all).")
    ] = None,
    batch: Annotated[int, typer.Option(min=1, help="Images a batch.")] = 16,
    rate: Annotated[float, typer.Option(min=1e-7, max=1.0, help="The highest learning rate.")] = 4e-4,
    save_every: Annotated[int, typer.Option(min=1, help="Steps between two saves.")] = 1000,
    validate_every: Annotated[
        int | None, typer.Option(min=1, help="Steps between two judgements, at a save (default: at every one).")
    ] = None,
    workers: Annotated[int, typer.Option(min=0, help="Processes that prepare images (0: none beside this one).")] = 2,
    min_height: Annotated[
        float, typer.Option(min=0.0, max=65535.0, help="Height, px, of the true instances that a judgement is about.")
    ] = 25.0,
    device: Annotated[str, typer.Option(help="cuda, cpu, or auto.")] = "auto",
    precision: Annotated[
        str, typer.Option(help="fp32, fp16 (CUDA), bf16, or auto: 16 bits where the processor multiplies them.")
    ] = "auto",
    threads: Annotated[int | None, typer.Option(min=1, help="Of this process on a CPU (default: one a core).")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of everything that is drawn by chance.")] = 0,
) -> None:
    """Learn to find objects; OUT gets model.safetensors (16 bits), curves.png and what a resumption needs.

    Interrupted or killed, the same command goes on from the last save, also with more steps, another size or rate.
    """
    import cv2
    import torch

    from services.cli.train.segmenter_validation import Validation
    from services.runtime.torch_device import torch_device
    from services.segmenter.solov2.variants import VARIANTS
    from services.segmenter.training.trainer import Precision, Trainer, TrainingOptions
    from services.segmenter.weights.imagenet_backbone import read_backbone

    if variant not in VARIANTS:
        raise InputError(f"--variant {variant}: expected one of {', '.join(VARIANTS)}")
    if precision not in get_args(Precision):
        raise InputError(f"--precision {precision}: expected one of {', '.join(get_args(Precision))}")
    if threads is not None:
        torch.set_num_threads(threads)
        cv2.setNumThreads(threads)
    categories = tuple(category or _CATEGORIES)
    samples = read_samples([parse_training_data(text) for text in data], categories)
    judged_by = [parse_training_data(text) for text in validate or ()]
    validation = Validation(judged_by, categories, VARIANTS[variant].test_size, min_height)
    out.mkdir(parents=True, exist_ok=True)
    options = TrainingOptions(
        variant=variant,
        categories=categories,
        sizes=tuple(_training_size(text) for text in size or _SIZES),
        steps=steps,
        batch=batch,
        peak_learning_rate=rate,
        warm_up=min(1000, max(1, steps // 10)) if warm_up is None else warm_up,
        cool_down=steps // 5 if cool_down is None else cool_down,
        seed=seed,
        precision=cast(Precision, precision),
    )
    weights = _weights(start_from, variant, categories)
    learned = None if backbone is None else read_backbone(backbone, VARIANTS[variant].backbone)
    trainer = Trainer(options, samples, out, torch_device(device, "--device"), workers, weights, learned)
    _train(trainer, validation, out, save_every, validate_every or save_every)
    print(out / MODEL_NAME)


def _training_size(text: str) -> tuple[int, int]:
    from services.cli.simulate_seeds import parse_size

    width, height = parse_size(text)
    if width % _MULTIPLE_PX or height % _MULTIPLE_PX:
        raise InputError(f"--size {text}: expected multiples of {_MULTIPLE_PX}, such as {_SIZES[0]}")
    return width, height


def _weights(path: Path | None, variant: str, categories: tuple[str, ...]) -> "dict[str, torch.Tensor] | None":
    if path is None:
        return None
    from services.segmenter.weights.model_file import load_solov2

    network, description = load_solov2(path)
    if (description.variant, description.categories) != (variant, categories):
        raise InputError(
            f"--start-from {path}: {description.variant} of {len(description.categories)} categories, expected "
            f"{variant} of {', '.join(categories)}"
        )
    return network.state_dict()


def _train(trainer: "Trainer", validation: "Validation", out: Path, save_every: int, validate_every: int) -> None:
    from services.segmenter.training.curves import draw_curves

    steps = trainer.options.steps
    console = Console(stderr=True)
    with Progress(console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("training", total=steps, completed=trainer.step)

        def report(step: "StepReport") -> None:
            for name, value in (("category loss", step.category_loss), ("mask loss", step.mask_loss)):
                trainer.curves.setdefault(name, []).append([step.step, value])
            progress.update(
                task,
                completed=step.step,
                description=f"training: category {step.category_loss:.3f}, mask {step.mask_loss:.3f}",
            )

        while trainer.step < steps:
            begun = trainer.step
            trainer.run(min(steps, begun + save_every), report)
            _save(trainer, out)
            said = f"step {trainer.step} of {steps}"
            for name in ("category loss", "mask loss"):
                since = [value for step, value in trainer.curves[name] if step > begun]
                said += f", {name} {sum(since) / len(since):.3f}"
            if trainer.step == steps or begun // validate_every < trainer.step // validate_every:
                for name, value in validation.judge(trainer.averaged_network()).items():
                    trainer.curves.setdefault(name, []).append([trainer.step, value])
                    said += f", {name} {value:.3f}"
            console.print(said, highlight=False)
            draw_curves(trainer.curves, out / CURVES_NAME)


def _save(trainer: "Trainer", out: Path) -> None:
    from services.segmenter.solov2.variants import VARIANTS
    from services.segmenter.weights.model_file import ModelDescription, save_model

    options = trainer.options
    description = ModelDescription(
        options.variant,
        options.categories,
        VARIANTS[options.variant].test_size,
        f"kinemap train segmenter, step {trainer.step} of {options.steps}, {len(trainer.samples)} images",
    )
    save_model(out / MODEL_NAME, description, trainer.averaged_network().state_dict(), half=True)
