"""Pictures of films of containers, of runs that are like them, and of what differs."""

import numpy
from matplotlib import image

from .container_studies import SHOWN, cut, drawn_frame, run_frames
from .objectives import draw_rungs

ROWS, GAP = 4, 4  # of report/clip_rows.png: film, run, contours, differences; pixels between its cells
BOTH, FILM_ALONE, RUN_ALONE = (0.6, 0.6, 0.6), (0.15, 0.35, 0.8), (0.85, 0.25, 0.15)  # colours: the report's


def reported_frames(study):
    """Numbers of the film's frames that the report shows, in the order of its columns."""
    return sorted(int(path.stem.split("_")[1]) for path in (study.folder / "out/report").glob("clip_0*.png"))


def film_cell(study, number):
    """A frame of the film as the report shows it, cut to the liquid."""
    frames = reported_frames(study)
    rows = image.imread(study.folder / "out/report/clip_rows.png")
    width, height = (rows.shape[1] + GAP) // len(frames), (rows.shape[0] + GAP) // ROWS
    left = frames.index(number) * width
    return rows[:height - GAP, left:left + width - GAP]


def differing(film, run):
    """Picture of two masks, and the share of the film's pixels that differ."""
    out = numpy.ones((*film.shape, 3))
    for where, colour in ((film & run, BOTH), (film & ~run, FILM_ALONE), (run & ~film, RUN_ALONE)):
        out[where] = colour
    return out, float((film ^ run).sum() / film.sum())


def masks_of(study, number):
    """Masks of the film and of the best run."""
    name = f"mask_{number:06d}.png"
    return tuple(cut(folder / name) > 0.5 for folder in (study.folder / "masks", study.best().folder / "masks_clip"))


def grey(mask):
    return numpy.where(mask[..., None], 1.0, 0.0) * numpy.ones(3)


def shown_frame(study):
    """The reported frame of the film that is nearest to the one that pictures of its run show."""
    of_run = run_frames(study.folder)
    return min(reported_frames(study), key=lambda number: abs(of_run[number] - drawn_frame(study.container)))


def compared_frame(results, name, study):
    """The picture of figure 6.4; the share of the liquid's pixels that differ."""
    number = shown_frame(study)
    film, run = masks_of(study, number)
    picture, share = differing(film, run)
    blank = numpy.ones((SHOWN[3], SHOWN[2], 3))
    results.pictures(name, [[("film", film_cell(study, number)), (f"run with {study.found['value']:.3g} Pa s", study.picture("answer", "liquid")), ("", blank)],
                            [("silhouette in the film", grey(film)), ("silhouette of the run", grey(run)), (f"{100 * share:.1f} % of the liquid differ", picture)]],
                     size=(4, 2.2))
    return share


def overview(results, name, study):
    """The picture of figure 6.2: reference preparation above, identification below."""
    number = shown_frame(study)
    film, run = masks_of(study, number)
    titles = ("film", "silhouette", "a simulation", "its silhouette", "what differs")
    pictures = (film_cell(study, number), grey(film), study.picture("answer", "liquid"), grey(run), differing(film, run)[0])
    with results.figure(name, columns=3, rows=2, size=(4, 2.4)) as panels:
        for axes, title, picture in zip(numpy.ravel(panels), titles, pictures):
            axes.set_axis_off()
            axes.set_title(title, fontsize=9)
            axes.imshow(picture)
        draw_rungs(panels[1][2], study)
        panels[1][2].legend(fontsize=6)


def grid_of(results, name, rows):
    results.pictures(name, rows, size=(2.4, 1.65))
