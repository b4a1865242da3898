// Unidirectional path tracing: light sampling and BSDF sampling at every vertex, combined by
// multiple importance sampling (Veach 1997), with unbiased Russian roulette.

#include "path.wgsl"

const LIGHT_SAMPLES: bool = true;
const BSDF_SAMPLES: bool = true;
const MAX_EDGES: u32 = 0xffffffffu;
