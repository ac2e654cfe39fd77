#pragma once
// Places of the parts of a scene in its file, for messages about what another renderer's form cannot express.

#include "common/core/error.h"
#include "common/reader/scene_file.h"

#include <string>
#include <vector>

namespace gib {

/// One <shape> of the scene's file.
struct ShapePlace {
    SourceLocation where, bsdf_where, emitter_where;  ///< places; without a bsdf or emitter, that of the shape
    std::string type, bsdf_type;                      ///< plugins; of a `twosided` the first bsdf in it; empty: none
};

struct ScenePlaces {
    SourceLocation root, sensor, film, medium, emitter;  ///< places of the first of each, else of the root
    std::vector<ShapePlace> shapes;                      ///< in the order of the file
};

/// Reads the scene's file again for the places. Throws InputError as load_scene() does.
ScenePlaces scene_places(const std::string& path, const SceneLoadOptions& options);

}  // namespace gib
