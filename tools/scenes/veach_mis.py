"""Plates of growing roughness that mirror lights of growing size (after Veach and Guibas 1995, figure 2)."""

import math

from .gltf import Gltf
from .shapes import box, normalize, plain_quad, sphere

EYE = [0, 1.7, 7.2]
LIGHTS_AT = [0, 2.75, -1.6]  # the middle of their row
LIGHTS = [  # name, x, radius, colour
    ("tiny light", -1.65, 0.02, [1, 0.55, 0.35]),
    ("small light", -0.6, 0.06, [1, 0.9, 0.5]),
    ("medium light", 0.55, 0.17, [0.5, 1, 0.65]),
    ("large light", 1.75, 0.42, [0.5, 0.7, 1]),
]
PLATES = [  # y and z of the middle, perceptual roughness
    (1.22, -1.0, 0.08),
    (0.74, -0.15, 0.16),
    (0.36, 0.85, 0.28),
    (0.09, 2.0, 0.45),
]
POWER = 45  # of each light, W


def build():
    gltf = Gltf(
        "Veach's MIS test",
        "Sampling the BSDF alone is noisy where a rough plate mirrors a small light, sampling the lights alone where "
        "a smooth plate mirrors a large one; multiple importance sampling is good everywhere. The four lights emit "
        "equal power: radiance = power / (4 pi^2 radius^2).",
    )
    grey = gltf.diffuse("grey", [0.32, 0.32, 0.34], doubleSided=True)
    gltf.node("floor", mesh=gltf.mesh("floor", (plain_quad([-9, -0.35, 9], [18, 0, 0], [0, 0, -12]), grey)))
    gltf.node("back wall", mesh=gltf.mesh("back wall", (plain_quad([-9, -0.35, -3], [18, 0, 0], [0, 9, 0]), grey)))
    add_plates(gltf)
    add_lights(gltf)
    gltf.camera("camera", eye=EYE, target=[0, 1.25, 0], yfov=34, aspect=1.5)
    return gltf


def add_plates(gltf):
    """Thin boxes, each tilted so that its middle mirrors the row of lights into the camera."""
    for y, z, roughness in PLATES:
        metal = gltf.material(f"metal, roughness {roughness}", [0.86, 0.86, 0.88], metallic=1, roughness=roughness)
        mesh = gltf.mesh(f"plate, roughness {roughness}", (box(), metal))
        to_eye = normalize([0, EYE[1] - y, EYE[2] - z])
        to_lights = normalize([0, LIGHTS_AT[1] - y, LIGHTS_AT[2] - z])
        tilt = math.atan2(to_eye[2] + to_lights[2], to_eye[1] + to_lights[1])
        turn = [math.sin(tilt / 2), 0, 0, math.cos(tilt / 2)]
        gltf.node(f"plate {roughness}", mesh=mesh, translation=[0, y, z], rotation=turn, scale=[4.6, 0.03, 0.72])


def add_lights(gltf):
    ball = sphere(3, smooth=False)
    for name, x, radius, color in LIGHTS:
        mean = sum(color) / 3
        radiance = POWER / (4 * math.pi**2 * radius**2) / mean
        mesh = gltf.mesh(name, (ball, gltf.emitter(name, color, radiance)))
        gltf.node(name, mesh=mesh, translation=[x, *LIGHTS_AT[1:]], scale=[radius] * 3)
