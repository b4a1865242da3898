// Emitters and the light that reaches surfaces from them without a further bounce.

#include "path.wgsl"

const LIGHT_SAMPLES: bool = true;
const BSDF_SAMPLES: bool = true;
const MAX_EDGES: u32 = 2u;
