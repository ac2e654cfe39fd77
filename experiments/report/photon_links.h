#pragma once
// The pages of `gibench photons` that belong to a result folder.

#include "experiments/results/result_folder.h"

#include <string>
#include <vector>

namespace gib {

/// A method that stores light, on a scene.
struct PhotonLink {
    std::string scene, method;
    std::string page;     ///< relative to the folder; empty if there is no page yet
    std::string command;  ///< makes the page
};

/// A link for each scene and each method of the folder that stores light.
std::vector<PhotonLink> photon_links(const ResultIndex& index, const ResultFolder& folder);

}  // namespace gib
