"""Rows of `seeing` on videos: contours against exact masks, times, rotation, bad input, films of a run."""

from .gtest import run_gtest
from .run import built, execute, scratch
from .table import Figure, Unmeasured

MEAN, DEVIATION, DRIFTING = 0.2, 0.5, 0.4 # [px]


def contours(context, case, mean):
    size = "Quick" if context.quick else "Full"
    report = run_gtest(context, "contour_accuracy", f"Films/ContourAccuracy.DISABLED_{size}/{case}")
    found = {key: float(value) for key, value in report.properties.items()}
    ok = report.ok and found["mean_px"] <= mean and found["deviation_px"] <= DEVIATION
    return Figure(f"worst of {found['frames']:.0f} frames: mean {found['mean_px']:.3f} px, s.d. {found['deviation_px']:.3f} px, "
                  f"intersection over union {found['overlap']:.4f}", ok)


def add_contours(table):
    asked = f"mean <= {MEAN} px, s.d. <= {DEVIATION} px"
    cases = [
        ("sharp, dark on light", "DarkSharp", MEAN),
        ("sharp, light on dark", "LightSharp", MEAN),
        ("blur of 4 px, dark on light", "DarkBlur4", MEAN),
        ("blur of 4 px, light on dark", "LightBlur4", MEAN),
        ("blur of 4 px made in the file's numbers", "DarkBlur4Code", MEAN),
        ("liquid at rest for 10 s", "DarkStill", MEAN),
        ("exposure drifts by +- 20 %", "DarkDrift", DRIFTING),
        ("exposure drifts by +- 20 %, blur of 4 px, dark on light", "DarkBlur4Drift", DRIFTING),
        ("exposure drifts by +- 20 %, blur of 4 px, light on dark", "LightBlur4Drift", DRIFTING),
        ("method difference, blur of 2 px, drift of 20 %", "Difference", DRIFTING),
        ("method threshold, blur of 2 px, drift of 10 %", "Threshold", DRIFTING),
    ]
    for text, case, mean in cases:
        table.row(f"video contour, {text}", claim="contour of a 1280 x 720 film at 30 Hz, after closing and opening, against its exact mask",
                  asked=asked if mean == MEAN else f"mean <= {mean} px, s.d. <= {DEVIATION} px")(
            lambda context, case=case, mean=mean: contours(context, case, mean))


def tests_row(table, name, claim, asked, program, pattern):
    def measure(context):
        report = run_gtest(context, program, pattern)
        return Figure(report.text(), report.ok)

    table.row(name, claim=claim, asked=asked)(measure)


def masks_pass(context):
    import matplotlib.image
    data = context.root.parent / "shared" / "data" / "virheometry"
    if not data.is_dir():
        raise Unmeasured("needs ../shared/data/virheometry")
    count = differing = 0
    for folder in sorted((data / "experiments").iterdir()):
        with scratch(context, "masks") as out:
            execute(context, [built(context, "treacle"), "silhouettes", folder / "config_%02d.png", "--rate", 24, "--method", "masks",
                              "--no-overlay", "--out", out / "masks"])
            for k in range(8):
                given = matplotlib.image.imread(folder / f"config_{k + 1:02d}.png")
                found = matplotlib.image.imread(out / "masks" / f"mask_{k:06d}.png")
                differing += int(((given[..., 0] < 0.5) != (found > 0.5)).sum())
                count += 1
    return Figure(f"{differing} of {count} x 1920 x 1080 pixels differ", differing == 0 and count == 32)


def add_rows(table):
    add_contours(table)
    tests_row(table, "video times", "variable rate, first stamp not zero, stored out of order, slow motion", "times to 1 ms", "clip",
              "*VariableStamps*:*OutOfOrder*:*SlowMotion*")
    tests_row(table, "video turned", "files turned by 0, 90, 180, 270 by their display matrix", "upright frames; the same masks", "clip", "*DisplayMatrix*:*QuarterTurn*")
    tests_row(table, "video turned, masks", "silhouettes of files turned by 0, 90, 180, 270", "the same masks, bit for bit", "silhouettes", "*TurnedFiles*")
    tests_row(table, "video methods", "methods, shadows, hands, drift of the camera, start of the motion", "as their tests say", "silhouettes",
              "Silhouettes.*:Cleaning.*:ContourError.*")
    tests_row(table, "video bad input", "cut off, interlaced, HDR, HEIC, pixels not square, sizes that differ, gaps", "named, with a cure", "clip",
              "*WhatIsNoVideo*:*CutOff*:*PicturesOf*")
    table.row("masks unchanged", claim="masks that are ready pass through: those of ViRheometry", asked="no pixel differs")(masks_pass)
