"""Cameras with OpenCV's distortion and their projections, for rows on cameras: written anew from the formulas, so that the
program is compared with something that is not itself."""

import dataclasses
import re
import struct
import zlib

import numpy

NAMES = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


@dataclasses.dataclass(frozen=True)
class Lens:
    width: int
    height: int
    values: tuple  # in the order of NAMES; pixels from the centre of the top left one

    def distort(self, x, y):
        k1, k2, p1, p2, k3, k4, k5, k6 = self.values[4:]
        rr = x * x + y * y
        c = (1 + rr * (k1 + rr * (k2 + rr * k3))) / (1 + rr * (k4 + rr * (k5 + rr * k6)))
        return x * c + 2 * p1 * x * y + p2 * (rr + 2 * x * x), y * c + p1 * (rr + 2 * y * y) + 2 * p2 * x * y

    def pixels(self, x, y):
        fx, fy, cx, cy = self.values[:4]
        u, v = self.distort(x, y)
        return cx + fx * u, cy + fy * v

    def rays(self, u, v):
        """Slopes X/Z, Y/Z of the rays through pixels, by fixed-point iteration to 1e-12."""
        fx, fy, cx, cy = self.values[:4]
        u, v = (u - cx) / fx, (v - cy) / fy
        x, y = u.copy(), v.copy()
        for _ in range(60):
            a, b = self.distort(x, y)
            x, y = x + (u - a), y + (v - b)
            if max(abs(u - a).max(), abs(v - b).max()) < 1e-12:
                break
        return x, y

    def corner_rays(self):
        """Rays through the corners of the pixels, [height + 1][width + 1]."""
        u, v = numpy.meshgrid(numpy.arange(self.width + 1) - 0.5, numpy.arange(self.height + 1) - 0.5)
        return self.rays(u, v)


def rotation(vector):
    angle = numpy.linalg.norm(vector)
    if angle == 0:
        return numpy.eye(3)
    x, y, z = numpy.asarray(vector) / angle
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross


def rotation_vector(matrix):
    sine = numpy.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]) / 2
    length = numpy.linalg.norm(sine)
    return sine * (numpy.arctan2(length, (numpy.trace(matrix) - 1) / 2) / length if length > 1e-12 else 1)


def project(lens, turn, shift, points):
    seen = points @ turn.T + shift
    return numpy.stack(lens.pixels(seen[:, 0] / seen[:, 2], seen[:, 1] / seen[:, 2]), axis=1)


def average(corner_rays, value_at, samples=8):
    """Mean over each pixel of value_at(x, y), which is constant but for jumps: pixels whose corners differ are sampled."""
    x, y = corner_rays
    values = value_at(x, y)
    out = values[:-1, :-1].astype(float)
    low = numpy.minimum.reduce([values[:-1, :-1], values[1:, :-1], values[:-1, 1:], values[1:, 1:]])
    high = numpy.maximum.reduce([values[:-1, :-1], values[1:, :-1], values[:-1, 1:], values[1:, 1:]])
    row, column = numpy.nonzero(low != high)
    total = numpy.zeros(len(row))
    for i in range(samples):
        for j in range(samples):
            a, b = (i + 0.5) / samples, (j + 0.5) / samples
            mixed = [(1 - a) * ((1 - b) * r[row, column] + b * r[row, column + 1])
                     + a * ((1 - b) * r[row + 1, column] + b * r[row + 1, column + 1]) for r in (x, y)]
            total += value_at(*mixed)
    out[row, column] = total / samples ** 2
    return out


def blurred(picture, deviation):
    """Convolved with a Gaussian; the rim repeats."""
    n = int(numpy.ceil(4 * deviation))
    kernel = numpy.exp(-0.5 * (numpy.arange(-n, n + 1) / deviation) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        padded = numpy.pad(picture, [(n, n) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        size = picture.shape[axis]
        picture = sum(w * numpy.take(padded, range(i, i + size), axis=axis) for i, w in enumerate(kernel))
    return picture


def write_png(path, grey):
    """An 8 bit grey picture, [height][width]."""
    height, width = grey.shape
    rows = numpy.zeros((height, width + 1), numpy.uint8)
    rows[:, 1:] = grey

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b""))


def read_png(path):
    """The grey levels of an 8 bit PNG without interlacing, [height][width]."""
    import matplotlib.image

    picture = matplotlib.image.imread(path)
    return picture if picture.ndim == 2 else picture[..., :3].mean(axis=2)


def read_camera(path):
    """Arrays of a camera file by key, and its image size."""
    text = path.read_text()
    out = {}
    for key, data in re.findall(r"^(\w+): !!opencv-matrix.*?data: \[(.*?)\]", text, re.MULTILINE | re.DOTALL):
        out[key] = numpy.array([float(word) for word in data.split(",")])
    for key, number in re.findall(r"^(\w+): ([-+.\de]+)$", text, re.MULTILINE):
        out[key] = float(number)
    return out


def lens_of(camera):
    m, d = camera["camera_matrix"], camera["distortion_coefficients"]
    return Lens(int(camera["image_width"]), int(camera["image_height"]), (m[0], m[4], m[2], m[5], *d))
