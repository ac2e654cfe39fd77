#pragma once
// The light that a method stores, as far as a page can show it, and the image that the method makes of it.

#include "common/reader/scene_file.h"
#include "experiments/measuring/measure.h"
#include "methods/method.h"
#include "methods/parts/stored_light/stored_light.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The places of each group if there are `places` in all: as many for each group as for every other, but no more than
/// its `counts`; what small groups leave goes to the others. Groups at the end get what does not divide evenly.
std::vector<std::size_t> even_shares(const std::vector<std::size_t>& counts, std::size_t places);

/// Whether item i of `count` is among `shown` items taken at even steps. The product of both numbers is below 2^64.
inline bool is_at_step(std::size_t i, std::size_t count, std::size_t shown) {
    return (i + 1) * shown / count > i * shown / count;
}

/// A uniform subset of the photons of several maps and passes, in memory that does not grow with the number of photons.
/// Each photon gets a random number, and the photons with the least numbers are kept (bottom-k sampling). Every subset
/// of this size is equally likely, whatever the order in which photons arrive.
class PhotonSubset {
public:
    /// Keeps at most `most` photons, in even shares of the maps.
    explicit PhotonSubset(std::size_t most) : most_(most) {}

    /// Adds the photons of a map. Those of one pass are added once.
    void add(const StoredPhotons& stored, std::uint32_t pass);

    struct Shown {
        std::uint64_t number;  ///< random
        Photon photon;
        std::uint32_t pass;
    };
    struct Map {
        std::string name;
        std::uint64_t stored = 0;      ///< photons of all passes
        std::uint64_t emitted = 0;     ///< photons emitted for it in all passes
        std::uint64_t not_finite = 0;  ///< number of these photons without a finite power
        double power = 0;              ///< sum over photons, mean of the channels [W]
        double unit = 1;               ///< unit of the photons' power [W]
        std::vector<Shown> shown;

        /// [W] of a photon; 0 without photons.
        double mean_power() const { return stored > not_finite ? power / static_cast<double>(stored - not_finite) : 0; }
    };
    /// The maps in the order of their first photons. The photons of a map are in random order.
    std::vector<Map> maps() const;

private:
    static void keep_least(std::vector<Shown>& photons, std::size_t count);

    std::size_t most_;
    std::vector<Map> maps_;
};

struct StoredLightWork {
    const LoadedScene& scene;
    const ConfiguredMethod& method;
    std::uint64_t seed = 1;
    std::uint32_t most_passes;                               ///< 1 to 255
    std::size_t most_photons;                                ///< number of photons shown
    StageTimes::Listener listener = StageTimes::Listener();  ///< receives the progress
};

struct CollectedLight {
    std::vector<PhotonSubset::Map> photons;
    StoredBeams beams;             ///< `emitted`: for those of all passes
    std::size_t stored_beams = 0;  ///< `beams` are some of them, evenly spaced
    std::vector<StoredRecord> records;
    StoredPatches patches;
    std::uint32_t passes = 0;          ///< number of passes made
    bool photons_of_passes = false;    ///< whether each pass has photons of its own
    std::vector<std::string> skipped;  ///< passes of the plan that were not run, with the reasons

    bool empty() const { return photons.empty() && beams.beams.empty() && records.empty() && patches.patches.empty(); }
};

/// Throws InputError, which names the methods that store light, if the method is none of them.
void require_stored_light(const MethodLabel& method);

/// Makes passes until a further one would store no other light, at most `most_passes`; none if the start stores all.
/// The photons are those of all passes made, beams, records and patches those after the last.
CollectedLight collect_stored_light(const StoredLightWork& work);

struct ShownImageWork {
    const LoadedScene& scene;
    const ConfiguredMethod& method;
    std::uint64_t seed = 1;
    std::uint32_t passes;        ///< a run that converges ends earlier
    WorkObserver observer = {};  ///< receives the progress
};

/// An image, and what its estimates use.
struct ShownImage {
    ComponentImages image;
    std::uint32_t passes = 0;
    std::uint64_t emitted = 0;                 ///< photons emitted for it
    std::optional<double> k = {};              ///< photons in an estimate; empty: the method takes no number
    std::map<std::string, double> radii = {};  ///< largest radius of a look-up in each map at the start [scene units]
    std::int64_t gather = 0;                   ///< rays in place of look-ups in the global map
};

/// Renders the image as `gibench render` does with as many passes.
ShownImage shown_image(const ShownImageWork& work);

/// The pixels of an image that a page keeps: all, or evenly spaced ones.
struct PixelGrid {
    int width, height;  ///< of the image
    int columns, rows;

    /// At most `most` pixels, 1 or more.
    PixelGrid(int image_width, int image_height, int most);
    std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
    int x(std::size_t i) const { return static_cast<int>(i) % columns * width / columns; }
    int y(std::size_t i) const { return static_cast<int>(i) / columns * height / rows; }
};

}  // namespace gib
