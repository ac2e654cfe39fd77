#pragma once
// The <bsdf> elements of a scene file.

#include "common/material.h"
#include "common/xml_properties.h"

namespace gib {

/// diffuse, dielectric, conductor, or twosided with one or two of them inside. Throws InputError.
Material parse_bsdf(const XmlElement& element, const XmlIds& ids);

}  // namespace gib
