"""How much error is left in renders: figures of arrays, without files or programs.

A render is an array of rows, columns and three channels. relMSE is the mean of (x − r)² / (r² + 0.01) over pixels and channels of pictures
scaled to a mean of 0.25. Half of (a − b)² of two seeds stands for (x − r)²: it has no error of a reference. The r² below is of another
renderer, as a renderer's own has its outliers, which would make light of themselves; and at least of the 5 × 5 pixels about, as dark noise
would count many times.
"""
import numpy as np

TRIMMED = 1000 # one pixel of so many, the worst, is left out


def cut(image, region):
    """`region` is x0, y0, x1, y1 as shares of the sides."""
    height, width = image.shape[:2]
    x0, y0, x1, y1 = (round(share * side) for share, side in zip(region, (width, height, width, height)))
    return image[y0:y1, x0:x1]


def whole_and_trimmed(pixels):
    pixels = np.sort(pixels.mean(axis=2).ravel())
    return pixels.mean(), pixels[: len(pixels) - len(pixels) // TRIMMED].mean()


def about(image, reach=2):
    """Means of (2 reach + 1)² pixels, fewer at the edge."""
    padded = np.pad(image, ((reach, reach), (reach, reach), (0, 0)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (2 * reach + 1, 2 * reach + 1), axis=(0, 1))
    return np.nanmean(windows, axis=(-2, -1))


def errors_between(images, region, others=None):
    """relMSE of one render, and trimmed, by pairs of seeds. `others` are renders of another renderer, for r."""
    cuts = [cut(image, region) for image in images]
    reference = np.mean([cut(image, region) for image in others or images], axis=0)
    mean = reference.mean()
    reference = np.maximum(reference, about(reference))
    weight = 0.5 * (0.25 / np.mean(cuts)) ** 2 / ((0.25 / mean * reference) ** 2 + 0.01)
    return {(i, j): whole_and_trimmed(weight * (cuts[i] - cuts[j]) ** 2) for i in range(len(cuts)) for j in range(i)}


def errors_against(images, truth, region):
    """The same with bias: against the mean of another renderer's renders, less what noise that mean has, by seeds.

    The brightness of whole pictures is made the same, so bias of the region counts and another exposure does not.
    """
    brightness = np.mean(truth) / np.mean(images)
    reference = np.mean([cut(image, region) for image in truth], axis=0)
    noise = np.var([cut(image, region) for image in truth], axis=0, ddof=1) / len(truth)
    scale = 0.25 / reference.mean()
    weight = scale ** 2 / ((scale * reference) ** 2 + 0.01)
    return {(i, i): whole_and_trimmed(weight * ((brightness * cut(image, region) - reference) ** 2 - noise))
            for i, image in enumerate(images)}


def efficiency(errors, seconds):
    """1 / (relMSE × core-seconds) of all pixels, two standard errors of it (jackknife over seeds; NaN of too few), and trimmed."""
    k = len(seconds)

    def of(seeds):
        chosen = [e for (i, j), e in errors.items() if i in seeds and j in seeds]
        spent = np.mean([seconds[s] for s in seeds])
        return 1 / (np.mean(chosen, axis=0) * spent) if chosen else np.full(2, np.nan)

    whole, trimmed = of(range(k))
    left_out = np.array([of([s for s in range(k) if s != out])[0] for out in range(k)])
    spread = 2 * np.sqrt((k - 1) / k * ((left_out - left_out.mean()) ** 2).sum())
    return float(whole), float(spread), float(trimmed)


def coarse_difference(images, others, blocks=16):
    """Root of the relMSE between two renderers' means of blocks × blocks parts of the picture: whether they show the same."""
    def coarse(pictures):
        mean = np.mean(pictures, axis=0)
        rows = np.array_split(mean, blocks, axis=0)
        parts = np.array([[part.mean(axis=(0, 1)) for part in np.array_split(row, blocks, axis=1)] for row in rows])
        return parts.mean(axis=2) * 0.25 / parts.mean() # without colour, in which spectra and RGB differ
    a, b = coarse(images), coarse(others)
    return float(np.sqrt(((a - b) ** 2 / (b ** 2 + 0.01)).mean()))


def samples_for(renderer, seconds):
    """A power of two, which Sobol points like best, so that one render takes about as long as that: at most 1.4 times. Two
    renders tell what a sample costs and what each render costs besides, as pilots do, whose share falls with the samples.
    Where a renderer does something for the first time between the two, such as learning guides, they make samples seem too
    dear: so the number is doubled as long as one render with twice as many keeps to the time."""
    before, spent, samples = (0, 0.0), 0.0, 1
    while spent < 0.45 * seconds and samples < 1 << 22:
        before = (samples, spent)
        samples *= 4
        _, spent = renderer.render(samples, 1000 + samples)
    each = max((spent - before[1]) / (samples - before[0]), 0.25 * spent / samples) # the difference of two renders is noisy
    besides = max(spent - each * samples, 0)
    fitting = max(1, 2 ** round(np.log2(max((seconds - besides) / each, 1))))
    while fitting < 1 << 22 and renderer.render(2 * fitting, 2000 + fitting)[1] <= 1.4 * seconds:
        fitting *= 2
    return fitting
