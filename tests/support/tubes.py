"""Known tubes, cut, closed, turned and spoiled as files of other programs have them: points and polygons."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pearlbvp.mesh.families import jittered, tube_mesh

L = 10.0


def pearl(x, phi):
    r = 1 + 0.15 * np.cos(2 * np.pi * x / L)
    return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))


def helix(x, phi):
    """A tube that is nowhere its own image half a period on."""
    k = 2 * np.pi / L
    return np.column_stack((x, 0.5 * np.cos(k * x) + np.cos(phi), 0.5 * np.sin(k * x) + np.sin(phi)))


def bent(x, phi):
    """A pearled buckle, shorter along x where it bends."""
    k = 2 * np.pi / L
    r = 1 + 0.1 * np.cos(2 * k * x)
    return np.column_stack(
        (x + 0.3 * np.cos(phi) * np.sin(k * x), 0.6 * np.cos(k * x) + r * np.cos(phi), r * np.sin(phi))
    )


def known(surface=helix, nodes=220, jitter=0.0):
    """A mesh whose area and volume are exact for its flat triangles."""
    if jitter:
        return jittered(tube_mesh(L, nodes), jitter, surface=surface)
    return tube_mesh(L, nodes, surface)


@dataclass(frozen=True)
class Polygons:
    """What is written into a file."""

    points: np.ndarray
    faces: list

    def moved(self, matrix=None, by=(0, 0, 0)):
        points = self.points if matrix is None else self.points @ np.asarray(matrix).T
        return replace(self, points=points + by)

    @property
    def triangles(self):
        return np.array(self.faces)


def cut(mesh, slope=(0.0, 0.0), ragged=0.0, start=0.0, seed=0):
    """One period: triangles from where a plane, or a ragged line near it, goes through the tube."""
    noise = ragged * np.random.default_rng(seed).uniform(-1, 1, len(mesh.triangles))
    centroids = mesh.corners.mean(axis=1)
    periods = np.floor((centroids @ [1, *slope] + noise - start) / L).astype(int)
    wraps = mesh.wraps - periods[:, None]
    pairs, number = np.unique(np.column_stack((mesh.triangles.ravel(), wraps.ravel())), axis=0, return_inverse=True)
    points = mesh.vertices[pairs[:, 0]] + L * pairs[:, 1:] * [1, 0, 0]
    return Polygons(points, number.reshape(-1, 3).tolist())


def wrapped(mesh):
    """Without a last row: triangles lead back to the first."""
    vertices = mesh.vertices - L * np.floor(mesh.vertices[:, :1] / L) * [1, 0, 0]
    return Polygons(vertices, mesh.triangles.tolist())


def grid(surface=pearl, around=12, along=18, repeated=True):
    """Quads, each row of which begins where the last one ends."""
    x, phi = np.meshgrid(np.arange(along + repeated) * L / along, 2 * np.pi * np.arange(around) / around, indexing="ij")
    rows = along + 1 if repeated else along
    faces = [
        [
            i * around + j,
            i * around + (j + 1) % around,
            (i + 1) % rows * around + (j + 1) % around,
            (i + 1) % rows * around + j,
        ]
        for i in range(along)
        for j in range(around)
    ]
    return Polygons(surface(x.ravel(), phi.ravel()), faces)


def ends(polygons):
    """The two open ends, each as vertices in order."""
    directed = {(a, b) for face in polygons.faces for a, b in zip(face, face[1:] + face[:1], strict=True)}
    after = {a: b for a, b in directed if (b, a) not in directed}
    loops = []
    while after:
        at, loop = next(iter(after)), []
        while at in after:
            loop.append(at)
            at = after.pop(at)
        loops.append(loop)
    return loops


def capped(polygons, kind, only=2):
    """Ends closed by one polygon each, by triangles about a new middle, or by triangles between the corners."""
    points, faces = polygons.points, list(polygons.faces)
    for loop in ends(polygons)[:only]:
        loop = loop[::-1]
        if kind == "polygon":
            faces.append(loop)
        elif kind == "middle":
            points = np.vstack((points, points[loop].mean(axis=0)))
            faces += [[a, b, len(points) - 1] for a, b in zip(loop, loop[1:] + loop[:1], strict=True)]
        else:
            faces += [[loop[0], loop[i], loop[i + 1]] for i in range(1, len(loop) - 1)]
    return Polygons(points, faces)


def soup(polygons):
    """Every face with vertices of its own."""
    flat = [corner for face in polygons.faces for corner in face]
    sizes = np.cumsum([0] + [len(face) for face in polygons.faces])
    return Polygons(polygons.points[flat], [list(range(a, b)) for a, b in pairwise(sizes)])


def turned_round(polygons, share, seed=0):
    """Some faces, or all, seen from inside."""
    rng = np.random.default_rng(seed)
    return replace(polygons, faces=[face[::-1] if rng.uniform() < share else face for face in polygons.faces])


def spoiled(polygons, seed=0):
    """Unused vertices, faces twice, faces without area of three kinds."""
    rng = np.random.default_rng(seed)
    points, faces = polygons.points, list(polygons.faces)
    points = np.vstack((points, rng.normal(size=(3, 3)), [[np.nan] * 3]))
    faces += [faces[i] for i in rng.integers(len(faces), size=4)] + [faces[7][::-1]]
    faces += [[faces[3][0], faces[3][1], faces[3][1]], [faces[5][0]] * 3]
    order = rng.permutation(len(faces))
    return Polygons(points, [faces[i] for i in order])


def row_of_three(polygons, at=40):
    """An edge that one side divides by a vertex and the other does not: a triangle without area lies between."""
    faces = list(polygons.faces)
    a, b, c = faces[at]
    points = np.vstack((polygons.points, polygons.points[[a, b]].mean(axis=0)))
    middle = len(points) - 1
    faces[at : at + 1] = [[a, middle, c], [middle, b, c], [a, b, middle]]
    return Polygons(points, faces)


def rotation(seed):
    """Any turn about the origin."""
    matrix = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return matrix * np.sign(np.linalg.det(matrix))
