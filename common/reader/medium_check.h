#pragma once
// Looks for media that contradict each other, and for boundaries of media that are open. Both load; a warning says where
// a path will be in another medium than the scene's author may think.

#include "common/core/error.h"
#include "common/scene/scene.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gib {

/// The media of a scene as its file names them. Indices of media are those of `names`.
struct NamedMedia {
    struct Boundary {
        SourceLocation where;  ///< place of the shape in the file
        MediumSides sides;
    };
    std::vector<Boundary> shapes;    ///< parallel to Scene::shapes()
    std::vector<std::string> names;  ///< names of the media, for messages
    std::uint32_t camera = no_medium;
};

/// Follows a few rays from the camera and from each lamp straight on through what lets light pass. A warning, with its
/// place in the file, for each boundary where such a ray arrives in another medium than the boundary names on that side.
/// As everywhere, a lamp is in the medium that the boundaries between camera and lamp lead to. A further warning, without
/// a place, if light from infinity starts in a medium, which has no boundary there and lets none of it through.
std::vector<std::string> contradictions(const Scene& scene, const NamedMedia& media);

/// The medium of the closed boundary in which the camera stands: all rays from there that leave a boundary leave the same
/// medium, and none escapes. Empty if there is none, or if the sensor names a medium.
std::optional<std::uint32_t> medium_around_camera(const Scene& scene, const NamedMedia& media);

/// A warning for each medium inside meshes whose boundary is open: some edges belong to one triangle only. The edges of
/// all meshes with the same interior count together, so that six rectangles may close a box.
std::vector<std::string> open_boundaries(const Scene& scene, const NamedMedia& media);

}  // namespace gib
