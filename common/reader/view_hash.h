#pragma once
// The hash by which two images are known to show the same scene, whatever their files ask for besides.

#include "common/core/files.h"
#include "common/reader/scene_sensor.h"

namespace gib {

/// LoadedScene::view_hash of an expanded scene. `files`: the hash of its meshes and textures.
std::string view_hash_of(const XmlElement& root, const ContentHash& files, const ParsedSensor& sensor,
                         const ParsedIntegrator& integrator);

}  // namespace gib
