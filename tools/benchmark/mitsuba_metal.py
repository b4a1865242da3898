"""glTF's metal for Mitsuba: GGX, height-correlated shadowing, Schlick's Fresnel term; as shaders/bsdf/ggx.wgsl.

Mitsuba's own rough conductor has another shadowing term (uncorrelated) and the exact Fresnel equations. A BSDF in
Python is traced once and compiled into the same kernel as those in C++.
"""

import drjit
import mitsuba

# Classes of the chosen variant are what a BSDF derives from.
mitsuba.set_variant("llvm_ad_rgb")
NAME = "gltf_metal"


class Metal(mitsuba.BSDF):
    """alpha: GGX roughness; specular: reflectance at normal incidence."""

    def __init__(self, props):
        mitsuba.BSDF.__init__(self, props)
        self.alpha = props.get("alpha", 0.1)
        self.specular = mitsuba.Color3f(props["specular"])
        flags = mitsuba.BSDFFlags.GlossyReflection | mitsuba.BSDFFlags.FrontSide
        self.m_components, self.m_flags = [flags], flags

    def distribution(self):
        return mitsuba.MicrofacetDistribution(mitsuba.MicrofacetType.GGX, self.alpha, True)

    def smith_term(self, w):
        """√(z² + α² (x² + y²)) / z, which is 1 + 2 Λ."""
        return drjit.sqrt(w.z * w.z + self.alpha**2 * (w.x * w.x + w.y * w.y)) / w.z

    def fresnel(self, cosine):
        m = drjit.clip(1 - cosine, 0, 1)
        return self.specular + (1 - self.specular) * ((m * m) * (m * m) * m)

    def sample(self, ctx, si, sample1, sample2, active):
        h, pdf = self.distribution().sample(si.wi, sample2)
        cosine = drjit.dot(si.wi, h)
        wo = 2 * cosine * h - si.wi
        active &= (si.wi.z > 0) & (wo.z > 0) & (pdf > 0)
        sample = drjit.zeros(mitsuba.BSDFSample3f)
        sample.wo, sample.pdf, sample.eta = wo, pdf / (4 * cosine), 1
        sample.sampled_type = mitsuba.UInt32(+mitsuba.BSDFFlags.GlossyReflection)
        sample.sampled_component = mitsuba.UInt32(0)
        # f cos / pdf = F G2 / G1(wi).
        a, b = self.smith_term(si.wi), self.smith_term(wo)
        weight = self.fresnel(cosine) * ((1 + a) / (a + b))
        return sample, weight & active

    def eval(self, ctx, si, wo, active):
        active &= (si.wi.z > 0) & (wo.z > 0)
        h = drjit.normalize(si.wi + wo)
        masking = 2 / (self.smith_term(si.wi) + self.smith_term(wo))
        value = self.distribution().eval(h) * masking / (4 * si.wi.z)
        return (self.fresnel(drjit.dot(wo, h)) * value) & active

    def pdf(self, ctx, si, wo, active):
        active &= (si.wi.z > 0) & (wo.z > 0)
        h = drjit.normalize(si.wi + wo)
        density = self.distribution().pdf(si.wi, h) / (4 * drjit.dot(wo, h))
        return drjit.select(active, density, 0)

    def eval_pdf(self, ctx, si, wo, active):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def to_string(self):
        return f"Metal[alpha = {self.alpha}]"


mitsuba.register_bsdf(NAME, Metal)
