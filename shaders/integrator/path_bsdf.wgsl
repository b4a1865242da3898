// Path tracing by BSDF sampling alone: light samples are taken only of punctual lights, which no
// BSDF sample can find. For checking `path`: noisy where lights are small, never wrong.

#include "path.wgsl"

const LIGHT_SAMPLES: bool = false;
const BSDF_SAMPLES: bool = true;
const MAX_EDGES: u32 = 0xffffffffu;
