#pragma once
// Scene files of Mitsuba 0.4 to 1.x in the names and the meaning of Mitsuba 3.

#include "common/core/load_warnings.h"
#include "common/xml/xml_document.h"

namespace gib {

/// The version of a scene file.
struct SceneVersion {
    int major = 3, minor = 0;

    bool operator==(const SceneVersion&) const = default;
    bool before(int other_major, int other_minor) const {
        return major < other_major || (major == other_major && minor < other_minor);
    }
};

/// Reads the attribute `version` of a root element. Throws InputError unless it lies between 0.3 and 3.x.
SceneVersion parse_version(const XmlAttribute& version);

/// Whether a file has elements or camelCase parameters that only versions below 2 have.
bool has_old_names(const XmlElement& root);

/// Changes an element of a file of an older version, whose children have been upgraded and whose parameters have been
/// substituted, into what a file of version 3 would say, and marks it as old. Of version 2 it changes the names that version 3
/// does not have: the color of a constvolume, and the density or density_scale of a medium.
///
/// As Mitsuba 3 does itself with a version below 2 ("Differences to Mitsuba 0.6" in its documentation): names become lower case
/// with underscores (toWorld, intIOR), lookAt becomes lookat, the diffuse_reflectance of a diffuse becomes reflectance, and
/// uoffset, voffset, uscale and vscale become a to_uv that moves before it scales.
///
/// Where the documentation of Mitsuba 0.6 (Jakob 2014, by plugin) gives a scene another meaning than that of version 3:
///  - a <spectrum> of one or three numbers is linear RGB, and <srgb> has sRGB's curve; an <rgb> of #rrggbb has none;
///  - a bitmap's gamma of 1 means linear values (raw); 0, -1 and about 2.2 mean sRGB's curve, and others are read so with a
///    warning; wrap_mode_u and wrap_mode_v are one wrap_mode if they agree; the filters trilinear and ewa are read as bilinear,
///    with a warning;
///  - the distributions phong and as of rough surfaces are read as beckmann of the same roughness, with a warning;
///  - a conductor or roughconductor without a material and an index is copper, not a perfect mirror;
///  - a mixturebsdf is made of blendbsdfs; what the weights leave of 1 is absorbed, and a sum above 1 is scaled down, with a
///    warning;
///  - an alphaU or alphaV alone stands beside alpha, or 0.1;
///  - the scale of a bumpmap stands in a texture around its own, and the texture of a normalmap has no name;
///  - a medium's density_multiplier is its scale, and the density of a heterogeneous one its sigma_t; a constvolume has no
///    box, and a gridvolume has the one in its file; a homogeneous one without coefficients has those of the preset skin1,
///    which is refused;
///  - a <blackbody> is a spectrum of this type;
///  - up is y for sunsky, sky and sun, whose east is x and north -z (the documentation has north at z, which would make
///    the sky the mirror image of the real one; Mitsuba 0.6 itself does as here), and the albedo of their ground is 0.2 unless it
///    is given (the documentation has 0.15; Mitsuba 0.6 itself does as here);
///  - vertexcolors is the attribute vertex_color of a mesh, and the uvscale of a texture is its uscale and vscale, unless these are
///    given.
/// Three differences depend on more than the element, so that the readers see to them: spectra are converted without an
/// illuminant (scene_spectrum.h); reflectances above 1 are scaled down (model_reader.h); the boundary of a medium without a bsdf
/// lets light through (shape_reader.cpp).
///
/// As the files data/schema/upgrade_0.*.xsl of Mitsuba 0.6 say: before 0.5 a bumpmap was called bump. Before 0.4 a sensor was
/// called camera, looked at a mirrored world, and took its angle of view on the smaller side unless map_smaller_side was false; an emitter was
/// called luminaire, radiance and irradiance intensity, and an envmap's scale intensity_scale.
void upgrade_element(XmlElement& element, const SceneVersion& version, LoadWarnings& warnings);

}  // namespace gib
