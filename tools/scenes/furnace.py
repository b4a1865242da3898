"""A furnace: the radiance is known in closed form everywhere."""

from .gltf import Gltf
from .shapes import Shape

FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def build():
    gltf = Gltf(
        "furnace",
        "A closed box whose inner faces all emit Le = 1 and reflect the fraction rho = 0.5 as Lambert's law has it "
        "(metallic 0, specularFactor 0). Claim: the radiance is the same everywhere and in every direction. If what "
        "arrives at a point has the radiance L from all directions, the irradiance is pi L, the point reflects "
        "(rho / pi) pi L = rho L, and so the equation L = Le + rho L holds at every point: L = Le / (1 - rho) = 2. "
        "Each further edge of a path adds the factor rho, so paths of at most N edges (--max-depth N) give "
        "Le (1 + rho + ... + rho^(N-1)) = Le (1 - rho^N) / (1 - rho): 1 for N = 1, 1.5 for N = 2, 1.75 for N = 3, "
        "2 - 2^(1-N) in general. Neither the box's shape nor the place of the camera enters. No light is lost "
        "between the faces: they share their 8 vertices.",
    )
    glow = gltf.diffuse("glowing wall", [0.5, 0.5, 0.5], emissiveFactor=[1, 1, 1])
    gltf.node("box", mesh=gltf.mesh("box", (inward_box(), glow)))
    gltf.camera("camera", eye=[0.4, 0.3, 0.7], target=[-0.6, -0.4, -1], yfov=70, aspect=1)
    return gltf


def inward_box():
    """[-1, 1]³ with its front faces inside and shared vertices, hence without normals."""
    positions = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    indices = [i for a, b, c, d in FACES for i in (a, c, b, a, d, c)]
    return Shape(positions, indices)
