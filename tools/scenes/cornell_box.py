"""A Cornell box of our own proportions, in metres."""

from .gltf import Gltf, about_y
from .shapes import box, frame, plain_quad

WHITE, RED, GREEN = [0.73, 0.72, 0.69], [0.58, 0.07, 0.06], [0.13, 0.42, 0.12]
H = 1.25  # half the room
LIGHT = (0.38, 0.62, 0.40, 0.60)  # the part of the ceiling that is light


def build():
    gltf = Gltf(
        "Cornell box",
        "Diffuse interreflection and colour bleeding under one area light, and a glossy metal block that casts a "
        "caustic. The light fills a hole in the ceiling, is one-sided and faces down, so no two surfaces coincide; "
        "everything but the tall block is exactly Lambertian (metallic 0, specularFactor 0).",
    )
    white = gltf.diffuse("white", WHITE, doubleSided=True)
    red = gltf.diffuse("red", RED, doubleSided=True)
    green = gltf.diffuse("green", GREEN, doubleSided=True)
    metal = gltf.material("brushed metal", [0.91, 0.88, 0.82], metallic=1, roughness=0.35)
    light = gltf.emitter("lamp", [1, 0.85, 0.62], 36)

    d = 2 * H
    walls = {
        "floor": (plain_quad([-H, 0, H], [d, 0, 0], [0, 0, -d]), white),
        "ceiling": (frame([-H, d, -H], [d, 0, 0], [0, 0, d], *LIGHT), white),
        "back wall": (plain_quad([-H, 0, -H], [d, 0, 0], [0, d, 0]), white),
        "left wall": (plain_quad([-H, 0, H], [0, 0, -d], [0, d, 0]), red),
        "right wall": (plain_quad([H, 0, -H], [0, 0, d], [0, d, 0]), green),
        "lamp": (lamp(), light),
    }
    for name, (shape, material) in walls.items():
        gltf.node(name, mesh=gltf.mesh(name, (shape, material)))

    block = box(bottom=False)
    tall, short = gltf.mesh("metal block", (block, metal)), gltf.mesh("white block", (block, white))
    gltf.node("tall block", mesh=tall, translation=[-0.42, 0, -0.4], rotation=about_y(19), scale=[0.72, 1.45, 0.72])
    gltf.node("short block", mesh=short, translation=[0.46, 0, 0.36], rotation=about_y(-17), scale=[0.7, 0.7, 0.7])
    gltf.camera("camera", eye=[0, H, 4.7], target=[0, H, 0], yfov=39.6, aspect=1)
    return gltf


def lamp():
    s0, s1, t0, t1 = LIGHT
    d = 2 * H
    return plain_quad([d * s0 - H, d, d * t0 - H], [d * (s1 - s0), 0, 0], [0, 0, d * (t1 - t0)])
