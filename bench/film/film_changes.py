"""Pictures of a flying ball, and what a camera, a room or a converter may change in them: for
altered_film.py. Every change takes a Film and gives its pictures with the camera's noise."""
import io
import math

import numpy as np

WIDTH, HEIGHT, RADIUS, FRAMES, NOISE = 360, 240, 60, 40, 1.5
BACKGROUND, BLUR = 60, math.hypot(0.6, 12**-0.5)  # the lens's of synth, and a pixel's
PATTERNS = ('a1', 'b1', 'b2', 'c1', 'c3', 'd1', 'd3', 'e1', 'f1')
Y, X = np.mgrid[0:HEIGHT, 0:WIDTH]


def blurred(picture, sigma):
    reach = int(4 * sigma) + 1
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        margin = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        padded = np.pad(picture, margin, mode='edge')
        shape = picture.shape[axis]
        picture = sum(weight * padded.take(range(k, k + shape), axis)
                      for k, weight in enumerate(kernel))
    return picture


def covered(distance):
    """By the ball, so far from its centre."""
    return 0.5 * np.vectorize(math.erfc)((distance - RADIUS) / (math.sqrt(2) * BLUR))


def around(picture, side=3):
    """Each pixel's neighbours: (height, width, side, side)."""
    padded = np.pad(picture, side // 2, mode='reflect')
    return np.lib.stride_tricks.sliding_window_view(padded, (side, side))


class Film:
    """Pictures of light, 0 ... 255, with the ball's centre in each; `between`: so many to each of
    these, evenly spread over its frame's time, where PARTS asks for them."""

    def __init__(self, pictures, centres, seed, between=None):
        self.pictures, self.centres, self.between = pictures, centres, between
        self.random = np.random.default_rng(seed)

    def noise(self, sigma=NOISE):
        return self.random.normal(0, sigma, self.pictures.shape)

    def each(self, change):
        """With the camera's noise behind the change."""
        changed = np.array([change(p, x, y) for p, (x, y) in zip(self.pictures, self.centres)])
        return changed + self.noise()


def plain(film):
    return film.pictures + film.noise()


def hot_pixels(film):
    places = film.random.choice(WIDTH * HEIGHT, 90, replace=False)
    levels = film.random.integers(60, 255, 90)
    film.pictures.reshape(len(film.pictures), -1)[:, places] = levels
    return plain(film)


def dust(film):
    for _ in range(10):
        x, y = film.random.uniform(0, WIDTH), film.random.uniform(0, HEIGHT)
        film.pictures *= 1 - 0.15 * np.exp(-((X - x) ** 2 + (Y - y) ** 2) / (2 * 4.0**2))
    return plain(film)


def rows_of_noise(film):
    return plain(film) + film.random.normal(0, 2, (len(film.pictures), HEIGHT, 1))


def vignette(film):
    far = ((X - WIDTH / 2) ** 2 + (Y - HEIGHT / 2) ** 2) / (WIDTH / 2) ** 2
    return film.each(lambda p, x, y: p * (1 - 0.5 * far))


def shadow(film):
    """The ball's own, soft, on a wall behind it."""
    def cast(picture, x, y):
        dark = blurred(np.clip(RADIUS - np.hypot(X - x - 33, Y - y - 24), 0, 1), 5) * 0.6
        return picture - BACKGROUND * dark * (1 - covered(np.hypot(X - x, Y - y)))
    return film.each(cast)


def mirror(film):
    """A polished floor."""
    floor = HEIGHT // 2 + RADIUS + 6
    def reflect(picture, x, y):
        rows = min(HEIGHT - floor, floor)
        out = picture.copy()
        out[floor:floor + rows] = 0.7 * picture[floor:floor + rows] + (
            0.3 * picture[floor - rows:floor][::-1])
        return out
    return film.each(reflect)


def string(film):
    return film.each(lambda p, x, y: np.where((np.abs(X - x) < 1) & (Y < y - RADIUS + 2), 90, p))


def insect(film):
    pictures = film.each(lambda p, x, y: p)
    for k, picture in enumerate(pictures):
        near = (X - 20 - 7 * k) ** 2 + (Y - HEIGHT / 2 - 20 * math.sin(k / 3)) ** 2 < 36
        picture[near] = 100
    return pictures


def net(film):
    return film.each(lambda p, x, y: np.where((X % 40 < 2) | (Y % 40 < 2), 120, p))


def flicker(film):
    """By 15 % at either side, in turns."""
    pictures = film.pictures
    for k in range(len(pictures)):
        pictures[k] *= 1 + 0.15 * math.sin(1.3 * k) * (X - WIDTH / 2) / (WIDTH / 2)
    return plain(film)


def glint(film):
    return film.each(lambda p, x, y: p + 170 * np.exp(
        -((X - x + 18) ** 2 + (Y - y + 18) ** 2) / (2 * 4.8**2)))


def gamma(film):
    return film.each(lambda p, x, y: 255 * (np.clip(p, 0, 255) / 255) ** (1 / 2.2))


def sharpened(film):
    pictures = plain(film)
    return np.array([p + 0.8 * (p - blurred(p, 1.2)) for p in pictures])


def median(film):
    return np.array([np.median(around(p), axis=(2, 3)) for p in plain(film)])


def smooth_noise(film):
    noise = np.array([blurred(n, 0.8) for n in film.noise(1)])
    return film.pictures + 2 * noise / noise.std()


def bayer(film):
    """A colour camera's mosaic, interpolated, as luminance."""
    green = (X + Y) % 2 == 1
    cross = np.array([[0, 1, 0], [1, 4, 1], [0, 1, 0]])
    square = np.array([[1, 2, 1], [2, 4, 2], [1, 2, 1]])

    def filled(picture, here, weights):
        sums = (around(picture * here) * weights).sum((2, 3))
        return sums / (around(here.astype(float)) * weights).sum((2, 3))

    def luminance(picture):
        red = filled(picture, (X % 2 == 0) & (Y % 2 == 0), square)
        blue = filled(picture, (X % 2 == 1) & (Y % 2 == 1), square)
        return 0.299 * red + 0.587 * np.where(green, picture, filled(picture, green, cross)) + (
            0.114 * blue)
    return np.array([luminance(p) for p in film.pictures + film.noise(2.5)])


def ghosts(film):
    """A recorder's noise reduction: three tenths of what it has shown before."""
    pictures = plain(film)
    for k in range(1, len(pictures)):
        pictures[k] = 0.7 * pictures[k] + 0.3 * pictures[k - 1]
    return pictures


def jpeg(film):
    from PIL import Image

    def coded(picture):
        file = io.BytesIO()
        Image.fromarray(np.clip(picture + 0.5, 0, 255).astype(np.uint8)).save(
            file, 'JPEG', quality=75)
        return np.asarray(Image.open(file)).astype(float)
    return np.array([coded(p) for p in plain(film)])


def repeated(film):
    """Every seventh picture is the one before it, as a recorder makes good what it has lost."""
    pictures = plain(film)
    pictures[3::7] = pictures[2::7][:len(pictures[3::7])]
    return pictures


def shifted(picture, x, y):
    """Moved by so much, by its spectrum."""
    margin = 8
    padded = np.pad(picture, margin, mode='reflect')
    down, right = np.fft.fftfreq(padded.shape[0])[:, None], np.fft.rfftfreq(padded.shape[1])[None, :]
    turned = np.fft.rfft2(padded) * np.exp(-2j * np.pi * (right * x + down * y))
    return np.fft.irfft2(turned, padded.shape)[margin:-margin, margin:-margin]


def before_wall(film):
    """A wall with a texture, out of focus, that stands still."""
    wall = blurred(film.random.normal(0, 1, (HEIGHT, WIDTH)), 3)
    wall *= 25 / wall.std()
    for picture, (x, y) in zip(film.pictures, film.centres):
        picture += wall * (1 - covered(np.hypot(X - x, Y - y)))


def wall(film):
    before_wall(film)
    return plain(film)


def shaken(film):
    """A camera that shakes by half a pixel, before the wall."""
    before_wall(film)
    return np.array([shifted(p, 0.3 * math.sin(0.8 * k), 0.4 * math.sin(0.55 * k + 1))
                     for k, p in enumerate(film.pictures)]) + film.noise()


def knocked(film):
    """One that rings from the middle of the film on."""
    before_wall(film)
    size = [0.6 * math.exp((20 - k) / 8) if k >= 20 else 0 for k in range(len(film.pictures))]
    return np.array([shifted(p, s * math.sin(1.7 * (k - 20)), s * math.cos(1.3 * (k - 20)))
                     for k, (p, s) in enumerate(zip(film.pictures, size))]) + film.noise()


def panned(film):
    """One that turns slowly."""
    before_wall(film)
    return np.array([shifted(p, 0.05 * k, 0.02 * k)
                     for k, p in enumerate(film.pictures)]) + film.noise()


def written(film, rows, left, width):
    """White letters of 2 px strokes over the pictures, others in each."""
    pictures = plain(film)
    for picture in pictures:
        for top in rows:
            dots = film.random.integers(0, 2, (7, width))
            dots[:, ::6] = 0
            letters = np.kron(dots, np.ones((2, 2))) > 0
            picture[top:top + 14, left:left + 2 * width][letters] = 255
    return pictures


def clock(film):
    """At the edges, and over the ball's way."""
    return written(film, (12, HEIGHT // 2 + 30, HEIGHT - 20), 60, 60)


def reticle(film):
    pictures = plain(film)
    pictures[:, HEIGHT // 2] = pictures[:, :, WIDTH // 2] = 255
    pictures[:, HEIGHT // 2 - 3:HEIGHT // 2 + 4, ::20] = 255
    pictures[:, ::20, WIDTH // 2 - 3:WIDTH // 2 + 4] = 255
    return pictures


def letterbox(film):
    """Black above and below, over a part of the ball."""
    pictures = plain(film)
    pictures[:, :80] = pictures[:, -30:] = 0
    return pictures


def posterised(film):
    """Sixteen grey levels in all."""
    return np.round(plain(film) / 16) * 16


def dark(film):
    """A twelfth of the light, in whole grey levels."""
    return film.pictures / 12 + film.noise(0.5)


def doubled(film):
    """Recorded at half the size, every pixel shown four times."""
    count, height, width = len(film.pictures), HEIGHT // 2, WIDTH // 2
    small = film.pictures.reshape(count, height, 2, width, 2).mean((2, 4))
    small += film.random.normal(0, NOISE, small.shape)
    return small.repeat(2, 1).repeat(2, 2)


def resampling(to, size, linear):
    """Rows or columns of another number, by means of areas or between neighbours."""
    matrix, scale = np.zeros((to, size)), size / to
    for i in range(to):
        if linear:
            at = min(max((i + 0.5) * scale - 0.5, 0), size - 1)
            k = min(int(at), size - 2)
            matrix[i, k], matrix[i, k + 1] = 1 - (at - k), at - k
            continue
        for k in range(int(i * scale), math.ceil((i + 1) * scale)):
            matrix[i, k] = (min((i + 1) * scale, k + 1) - max(i * scale, k)) / scale
    return matrix


def enlarged(film):
    """Recorded at two thirds of the size, interpolated."""
    height, width = HEIGHT * 2 // 3, WIDTH * 2 // 3
    down, narrow = resampling(height, HEIGHT, False), resampling(width, WIDTH, False)
    up, wide = resampling(HEIGHT, height, True), resampling(WIDTH, width, True)
    return np.array([up @ (down @ p @ narrow.T + film.random.normal(0, NOISE, (height, width))) @
                     wide.T for p in film.pictures])


def torn(film):
    """Every sixth picture has the lower part of the one before it."""
    pictures = plain(film)
    for k in range(5, len(pictures), 6):
        row = int(film.random.integers(90, 150))
        pictures[k, row:] = pictures[k - 1, row:]
    return pictures


def lost_packets(film):
    """Every sixth picture has a black band."""
    pictures = plain(film)
    for k in range(5, len(pictures), 6):
        row = int(film.random.integers(40, 160))
        pictures[k, row:row + 40] = 0
    return pictures


def brighter(film):
    """A camera that sets its exposure anew."""
    return film.pictures * np.linspace(0.7, 1.1, len(film.pictures))[:, None, None] + film.noise()


def interlaced(film):
    """Odd rows half a frame later."""
    film.pictures = film.between[0::8].copy()
    film.pictures[:, 1::2] = film.between[4::8, 1::2]
    return plain(film)


def rolling(film):
    """Rows one after the other, all of the frame's time from the first to the last."""
    for k, picture in enumerate(film.pictures):
        for row in range(HEIGHT):
            time = 8 * (k + row / HEIGHT)
            at = min(int(time), len(film.between) - 2)
            picture[row] = (1 - (time - at)) * film.between[at, row] + (
                (time - at) * film.between[at + 1, row])
    # The rows about the centre show it later than the first row would.
    step = np.subtract(film.centres[-1], film.centres[0]) / (len(film.centres) - 1)
    film.centres = [(x, y) + step * (y / (HEIGHT - step[1])) for x, y in film.centres]
    return plain(film)


PARTS = 8  # of a frame's time, for those that ask for pictures in between
IN_BETWEEN = ('interlaced', 'rolling')
MOVED = ('shaken', 'knocked', 'panned')  # the camera


CHANGES = {c.__name__: c for c in (
    plain, hot_pixels, dust, rows_of_noise, vignette, shadow, mirror, string, insect, net, flicker,
    glint, gamma, sharpened, median, smooth_noise, bayer, ghosts, jpeg, repeated, wall, shaken, knocked,
    panned, clock, reticle, letterbox, posterised, dark, doubled, enlarged, torn, lost_packets,
    brighter, interlaced, rolling)}
