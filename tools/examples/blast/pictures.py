"""Draws the blast: the surfaces of the stadium in the colours of the pressure, the shock in the air, and two slices."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402
import PIL.Image  # noqa: E402

import colours  # noqa: E402
import gas  # noqa: E402
import raycast  # noqa: E402
import stadium  # noqa: E402

SUN = numpy.array((0.45, 0.35, 0.82))
STONE = {2: (0.42, 0.50, 0.60), 3: (0.40, 0.40, 0.43)}  # of grandstand and structure
NIGHT = numpy.array((0.030, 0.036, 0.050), numpy.float32)
WIDE, HIGH, SAMPLES = 1600, 800, 2
STEP = 0.5    # m along a ray through the air
INK, PAPER = "#c9ced8", "#0b0d12"
SECTION_X, PLAN_Z = stadium.CHARGE[0], stadium.CHARGE[2]


class View:
    """What does not change from frame to frame: which surface each ray meets, its light, and the cells of air before it."""

    def __init__(self, blast, eye=(-26, 36, 27), target=(14, -60, 17), degrees=68, wide=WIDE, high=HIGH):
        fine = numpy.load(blast.folder / "fine.npy").copy()
        fine[fine == 1] = 0  # the charge is gas at once
        cells = raycast.Cells(fine, stadium.DOMAIN_LOW, stadium.DOMAIN_LENGTH / fine.shape[2])
        camera = raycast.Camera(eye, target, wide, high, degrees)
        self.shape = high, wide
        rays = camera.directions(SAMPLES)
        distance, axis, material = cells.cast(camera.eye, rays)
        hit = numpy.nonzero(material != 255)[0]
        points = camera.eye + rays[hit] * distance[hit, None]
        normals = numpy.zeros((len(hit), 3))
        normals[numpy.arange(len(hit)), axis[hit]] = -numpy.sign(rays[hit, axis[hit]])
        light = self.light(cells, points, normals)
        base = numpy.zeros((256, 3), numpy.float32)
        for number, stone in STONE.items():
            base[number] = stone
        self.hit = hit
        self.stone = (base[material[hit]] * light[:, None]).astype(numpy.float32)
        self.glow = (0.55 + 0.45 * numpy.minimum(light, 1)).astype(numpy.float32)  # pressure is colour, light only shapes it
        self.air = raycast.Cells(blast.materials > 1, blast.corner, blast.width)
        self.seen, self.weights, self.inside = self.cells_before(blast, points, normals)
        self.fog_rays(camera, distance.reshape(high * SAMPLES, -1)[::SAMPLES * 2, ::SAMPLES * 2])

    @staticmethod
    def light(cells, points, normals):
        ahead = points + normals * 0.02
        sun = numpy.maximum(normals @ (SUN / numpy.linalg.norm(SUN)), 0)
        lit = numpy.nonzero(sun > 0)[0]
        _, _, blocked = cells.cast(ahead[lit], numpy.broadcast_to(SUN / numpy.linalg.norm(SUN), (len(lit), 3)))
        sun[lit] *= blocked == 255
        sky = numpy.ones(len(points))
        for radius in (1, 3, 8):  # how free the space ahead of a surface is, near and far
            share = cells.crowding(radius)
            sky *= 1 - 0.75 * cells.sample(share, points + normals * cells.width * (radius + 0.5))
        return sky * (0.42 + 0.18 * (normals[:, 2] + 1) / 2) + 0.75 * sun

    def cells_before(self, blast, points, normals):
        """For each point the eight cells of gas around a place just ahead of the surface, and their weights."""
        size = numpy.array(blast.materials.shape[::-1])
        place = (points + normals * 0.6 * blast.width - blast.corner) / blast.width - 0.5
        inside = ((place > -0.5) & (place < size - 0.5)).all(axis=1)
        place = numpy.clip(place[inside], 0, size - 1.001)
        base = place.astype(numpy.int32)
        part = (place - base).astype(numpy.float32)
        open_cells = numpy.zeros(blast.materials.shape, bool)
        open_cells[blast.index] = True
        seen, weights = [], []
        for corner in range(8):
            offset = numpy.array([corner & 1, corner >> 1 & 1, corner >> 2])
            i, j, k = (base + offset).T
            seen.append(numpy.ravel_multi_index((k, j, i), blast.materials.shape).astype(numpy.int32))
            weights.append(numpy.prod(numpy.where(offset, part, 1 - part), axis=1) * open_cells[k, j, i] + 1e-9 * open_cells[k, j, i])
        weights = numpy.array(weights, numpy.float32)
        total = weights.sum(axis=0)
        weights /= numpy.where(total > 0, total, 1)
        index = numpy.nonzero(inside)[0][total > 0]
        return numpy.array(seen)[:, total > 0], weights[:, total > 0], index

    def fog_rays(self, camera, distance):
        """Places along each fourth ray, up to what it meets, as numbers of cells twice as fine as those computed; -1 outside."""
        rays = camera.directions().reshape(*self.shape, 3)[::2, ::2].reshape(-1, 3)
        low, high = numpy.array(self.air.corner), self.air.corner + self.air.size * self.air.width
        safe = numpy.where(numpy.abs(rays) < 1e-6, 1e-6, rays)
        planes = numpy.stack([(low - camera.eye) / safe, (high - camera.eye) / safe])
        self.enter = numpy.maximum(planes.min(0).max(1), 0).astype(numpy.float32)
        self.leave = numpy.minimum(planes.max(0).min(1), distance.ravel()).astype(numpy.float32)
        self.eye, self.rays = camera.eye, rays.astype(numpy.float32)

    def draw(self, pressure):
        """The picture at one time, as RGB bytes."""
        over = numpy.nan_to_num(pressure - gas.P0).ravel()
        surface = self.stone.copy()
        mean = (over[self.seen] * self.weights).sum(axis=0)
        strength = numpy.clip(numpy.abs(mean) / 12e3, 0, 0.92)[:, None] ** 0.7
        surface[self.inside] = surface[self.inside] * (1 - strength) + colours.colour(mean) * self.glow[self.inside, None] * strength
        high, wide = self.shape
        image = numpy.empty((high * SAMPLES * wide * SAMPLES, 3), numpy.float32)
        image[:] = NIGHT
        image[self.hit] = surface
        image = image.reshape(high, SAMPLES, wide, SAMPLES, 3).mean(axis=(1, 3))
        light, veil = self.fog(pressure)
        image = image * veil[..., None] + light
        return (numpy.clip(image, 0, 1) ** (1 / 1.15) * 255 + 0.5).astype(numpy.uint8)

    def fog(self, pressure):
        """Light that the air sends to the eye along each ray, and the share of the light behind that it lets through."""
        over = numpy.nan_to_num(pressure - gas.P0)
        rise = numpy.zeros_like(over)  # the jump of pressure from cell to cell, in parts of the pressure: it marks shocks
        valid = numpy.isfinite(pressure)
        logs = numpy.log(numpy.where(valid, pressure, 1))
        for axis in range(3):
            jump = numpy.abs(numpy.diff(logs, axis=axis))
            both = numpy.logical_and(*(numpy.take(valid, numpy.arange(n, valid.shape[axis] - 1 + n), axis=axis) for n in (0, 1)))
            jump = numpy.where(both, jump, 0) ** 2
            for n in (0, 1):
                part = tuple(slice(n, jump.shape[axis] + n) if a == axis else slice(None) for a in range(3))
                rise[part] += jump / 2
        rise = numpy.sqrt(rise)
        thick = doubled(0.06 * numpy.clip((rise - 0.02) / 0.4, 0, 1), (0, 1, 2))
        haze = colours.colour(over) * 0.9 + numpy.array((0.10, 0.12, 0.15), numpy.float32)
        tint = doubled(haze, (0, 1, 2)).reshape(-1, 3)
        count = numpy.array(thick.shape[::-1])
        thick = thick.ravel()
        light, veil = numpy.zeros((len(self.rays), 3), numpy.float32), numpy.ones(len(self.rays), numpy.float32)
        alive = numpy.nonzero(self.leave > self.enter)[0]
        # The first steps differ from ray to ray, or the steps would show as bands.
        way = self.enter[alive] + STEP * numpy.random.default_rng(1).random(len(self.rays), numpy.float32)[alive]
        while len(alive):
            at = ((self.eye + self.rays[alive] * way[:, None] - self.air.corner) * (2 / self.air.width)).astype(numpy.int32)
            numpy.clip(at, 0, count - 1, out=at)
            cell = at[:, 0] + count[0] * (at[:, 1] + count[1] * at[:, 2])
            dimmed = numpy.exp(-STEP * thick[cell])
            light[alive] += (veil[alive] * (1 - dimmed))[:, None] * tint[cell]
            veil[alive] *= dimmed
            way = way + STEP
            on = (way < self.leave[alive]) & (veil[alive] > 0.01)
            alive, way = alive[on], way[on]
        high, wide = self.shape
        return doubled(light.reshape(high // 2, wide // 2, 3), (0, 1)), doubled(veil.reshape(high // 2, wide // 2), (0, 1))


def doubled(values, axes):
    """Twice as many cells along these axes, between which values change steadily."""
    for axis in axes:
        n = values.shape[axis]
        near = numpy.repeat(values, 2, axis=axis)
        order = numpy.clip(numpy.arange(2 * n) // 2 + numpy.where(numpy.arange(2 * n) % 2, 1, -1), 0, n - 1)
        values = (0.75 * near + 0.25 * numpy.take(values, order, axis=axis)).astype(numpy.float32)
    return values


def slice_picture(pressure, materials):
    picture = colours.colour(numpy.nan_to_num(pressure - gas.P0))
    picture[materials > 1] = (0.36, 0.40, 0.46)
    picture[(materials <= 1) & ~numpy.isfinite(pressure)] = (0.25, 0.27, 0.30)
    return picture


def draw_frame(path, blast, view, time):
    pressure = blast.array("p", time)
    figure = plt.figure(figsize=(16, 13.6), dpi=100, facecolor=PAPER)
    top = figure.add_axes((0, 1 - HIGH / 1360, 1, HIGH / 1360))
    top.imshow(view.draw(pressure), interpolation="nearest", aspect="auto")
    top.set_axis_off()
    top.text(0.018, 0.955, f"{float(time) * 1e3:5.1f} ms", transform=top.transAxes, color="white", fontsize=30, va="top", family="DejaVu Sans")
    w, corner, (nz, ny, nx) = blast.width, blast.corner, pressure.shape
    i, k = int((SECTION_X - corner[0]) / w), int((PLAN_Z - corner[2]) / w)
    x, y, z = ((corner[a], corner[a] + w * n) for a, n in enumerate((nx, ny, nz)))
    panels = [((0.045, 0.118, 0.475, 0.245), pressure[:, :, i], blast.materials[:, :, i], (*y, *z), f"section at x = {SECTION_X:g} m", "y, m", "z, m"),
              ((0.575, 0.098, 0.375, 0.285), pressure[k], blast.materials[k], (*x, *y), f"plan at z = {PLAN_Z:g} m", "x, m", "y, m")]
    for place, values, materials, extent, title, across, up in panels:
        axes = figure.add_axes(place)
        axes.imshow(slice_picture(values, materials), origin="lower", extent=extent, interpolation="nearest")
        axes.set_title(title, color=INK, fontsize=13, loc="left")
        axes.set_xlabel(across, color=INK)
        axes.set_ylabel(up, color=INK)
        axes.tick_params(colors=INK)
    colour_bar(figure, (0.2, 0.042, 0.6, 0.013))
    figure.savefig(path, facecolor=PAPER)
    plt.close(figure)


def draw_sheet(path, frames, columns=2, wide=600):
    """The upper parts of some frames in one small picture."""
    views = [PIL.Image.open(frame).convert("RGB").crop((0, 0, WIDE, HIGH)).resize((wide, wide * HIGH // WIDE), PIL.Image.LANCZOS) for frame in frames]
    gap, high = 6, wide * HIGH // WIDE
    rows = -(-len(views) // columns)
    sheet = PIL.Image.new("RGB", (columns * wide + (columns - 1) * gap, rows * high + (rows - 1) * gap), PAPER)
    for n, view in enumerate(views):
        sheet.paste(view, (n % columns * (wide + gap), n // columns * (high + gap)))
    sheet.save(path, optimize=True)


def colour_bar(figure, place):
    axes = figure.add_axes(place)
    low, high = colours.scale(colours.LOWEST), colours.scale(colours.HIGHEST)
    axes.imshow(colours.TABLE[None], aspect="auto", extent=(low, high, 0, 1))
    axes.set_yticks([])
    axes.set_xticks([float(colours.scale(t)) for t in colours.TICKS], [f"{t / 1e3:g}" for t in colours.TICKS])
    axes.tick_params(colors=INK)
    axes.set_xlabel("overpressure, kPa", color=INK)
