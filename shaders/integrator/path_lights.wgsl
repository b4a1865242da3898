// Path tracing by light sampling alone: emitters hit by a BSDF sample count only where no light
// sample can reach them. For checking `path`: noisy where surfaces are shiny, never wrong.

#include "path.wgsl"

const LIGHT_SAMPLES: bool = true;
const BSDF_SAMPLES: bool = false;
const MAX_EDGES: u32 = 0xffffffffu;
