"""Embree (PyPI embreex) on a scene's triangles: seconds to build, and closest-hit rays per second.

Runs under the Python that holds embreex: peer_embree SCENE WIDTH HEIGHT ROUNDS; prints JSON.
"""

import json
import sys
import threading
import time

import numpy
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from . import scene_reader

# Of the places in the pixels; of the directions, one more.
SEED = 1


def corners(scene):
    """(n, 3, 3), float32."""
    return numpy.concatenate([mesh.positions[mesh.triangles] for mesh in scene.meshes]).astype(numpy.float32)


def build(triangles):
    """((scene, mesh), seconds), at Embree's default quality. Embree builds at the first query, so one ray is in the time."""
    start = time.perf_counter()
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, triangles)
    ray = numpy.array([[0, 0, 1e6]], numpy.float32), numpy.array([[0, 0, 1]], numpy.float32)
    scene.run(*ray, query="INTERSECT")
    seconds = time.perf_counter() - start
    return (scene, mesh), seconds


def primary_rays(scene, width, height):
    """One a pixel, at a random place of its square, in the order of rows: origins and unit directions."""
    random = numpy.random.default_rng(SEED)
    x, y = numpy.meshgrid(numpy.arange(width), numpy.arange(height))
    place = numpy.stack([x, y], -1).reshape(-1, 2) + random.random((width * height, 2))
    half = numpy.tan(scene.yfov / 2)
    local = numpy.stack(
        [
            (2 * place[:, 0] / width - 1) * half * width / height,
            (1 - 2 * place[:, 1] / height) * half,
            -numpy.ones(len(place)),
        ],
        -1,
    )
    matrix = numpy.array(scene.camera)
    directions = local @ matrix[:3, :3].T
    directions /= numpy.linalg.norm(directions, axis=1, keepdims=True)
    origins = numpy.broadcast_to(matrix[:3, 3], directions.shape)
    return origins.astype(numpy.float32), directions.astype(numpy.float32)


def bounce_rays(triangles, rays, answer):
    """One from each hit, cosine-weighted about the normal that faces the ray."""
    hit = answer["primID"] >= 0
    origins, directions = rays[0][hit].astype(numpy.float64), rays[1][hit].astype(numpy.float64)
    a, b, c = (triangles[answer["primID"][hit]].astype(numpy.float64)[:, i] for i in range(3))
    normals = numpy.cross(b - a, c - a)
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals *= -numpy.sign((normals * directions).sum(1, keepdims=True))
    points = origins + directions * answer["tfar"][hit].astype(numpy.float64)[:, None]
    points += normals * 1e-4 * numpy.ptp(triangles.reshape(-1, 3), axis=0).max()
    # The normal and a point of the unit sphere sum to a cosine-weighted direction.
    sphere = numpy.random.default_rng(SEED + 1).normal(size=normals.shape)
    sphere /= numpy.linalg.norm(sphere, axis=1, keepdims=True)
    directions = normals + sphere
    directions /= numpy.maximum(numpy.linalg.norm(directions, axis=1, keepdims=True), 1e-300)
    return points.astype(numpy.float32), directions.astype(numpy.float32)


def trace(scene, rays, threads):
    """Seconds to find the closest hits, with the rays in as many equal parts."""
    parts = [[numpy.ascontiguousarray(part) for part in numpy.array_split(side, threads)] for side in rays]
    work = [threading.Thread(target=scene.run, args=(o, d), kwargs={"query": "INTERSECT"}) for o, d in zip(*parts)]
    start = time.perf_counter()
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()
    return time.perf_counter() - start


def measure(path, width, height, rounds):
    """Medians: build seconds, rays per second of each kind with one thread and with two."""
    source = scene_reader.read(path)
    triangles = corners(source)
    builds = []
    for _ in range(rounds):
        (scene, _mesh), seconds = build(triangles)
        builds.append(seconds)
    first = primary_rays(source, width, height)
    answer = scene.run(*first, query="INTERSECT", output=1)
    kinds = {"primary": first, "bounce": bounce_rays(triangles, first, answer)}
    times = {(kind, threads): [] for kind in kinds for threads in (1, 2)}
    for _ in range(rounds):
        for (kind, threads), seconds in times.items():
            seconds.append(trace(scene, kinds[kind], threads))
    rates = {
        f"{kind}_{threads}": len(kinds[kind][0]) / float(numpy.median(seconds))
        for (kind, threads), seconds in times.items()
    }
    return {"triangles": len(triangles), "build_seconds": float(numpy.median(builds)), "rays_per_second": rates}


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], *map(int, sys.argv[2:5]))))
