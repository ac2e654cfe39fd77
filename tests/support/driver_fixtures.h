#pragma once
// Fixtures of the driver's tests: a method without light transport, and the built program as a child process.

#include "common/core/files.h"
#include "common/images/film.h"
#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "tests/support/matchers.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <sys/wait.h>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

namespace gib::test {

/// A wall under a spherical lamp, seen by a camera of `size` x `size` pixels.
inline std::string tiny_scene_xml(int size = 8) {
    return Scene(element("sensor", "perspective", box_film(size),
                         element("sampler", "independent", integer("sample_count", 4))))
        .add(shape("rectangle", to_world(translate(0, 0, 5), rotate('y', 180), translate(0, 0, 10)), diffuse(0.5)))
        .sphere(0, 3, 2, 0.5, area_light(5))
        .xml();
}

/// How a FakeMethod behaves. Every pixel is 1 plus noise of standard deviation `noise`, a pure function of the seed,
/// the pass and the pixel. The start, a pass, the timed stage of a pass and the making of an image sleep for the given
/// times [s], so that a test sees which of them are charged.
struct FakeBehaviour {
    double noise = 0.5;
    double start_seconds = 0, pass_seconds = 0, image_seconds = 0, staged_seconds = 0;
    std::uint32_t converges_after = 0;  ///< [passes]; 0: never
    float unit = 1;                     ///< multiplies all light
};

inline void sleep_seconds(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

class FakeRun : public Run {
public:
    FakeRun(const FakeBehaviour& b, int width, int height, std::uint64_t seed, StageTimes& stages)
        : b_(b),
          film_(width, height, {Component::direct}, {}),
          pixels_(static_cast<std::size_t>(width * height)),
          seed_(seed),
          stages_(stages) {}

    Progress advance(std::uint32_t pass) override {
        EXPECT_EQ(pass, passes_) << "passes come in order";
        ++passes_;
        sleep_seconds(b_.pass_seconds);
        {
            const auto timer = stages_.time("staged");
            sleep_seconds(b_.staged_seconds);
        }
        for (std::size_t i = 0; i < pixels_; ++i) {
            const Sampler sampler(PointSet::independent, seed_, i, pass);
            PixelSample sample;
            sample[Component::direct] =
                b_.unit *
                Color::Constant(1.f + static_cast<float>(b_.noise) * (sampler.get_1d(0) - 0.5f) * std::sqrt(12.f));
            film_.add(i, pass, sample);
        }
        return b_.converges_after > 0 && passes_ >= b_.converges_after ? Progress::converged : Progress::more;
    }
    ComponentImages image() const override {
        sleep_seconds(b_.image_seconds);
        return film_.mean(passes_);
    }
    RunCounts counts() const override { return {0, passes_, film_.non_finite()}; }

private:
    FakeBehaviour b_;
    Film film_;
    std::size_t pixels_;
    std::uint64_t seed_;
    StageTimes& stages_;
    std::uint32_t passes_ = 0;
};

class FakeMethod : public Method {
public:
    explicit FakeMethod(const FakeBehaviour& b) : b_(b) {}
    Plan plan(const gib::Scene&) const override { return {}; }
    std::unique_ptr<Run> start(const gib::Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        sleep_seconds(b_.start_seconds);
        return std::make_unique<FakeRun>(b_, scene.sensor().width(), scene.sensor().height(), seed, stages);
    }

private:
    FakeBehaviour b_;
};

/// The exit code of a program (128 + the signal if one killed it) and its standard output and error.
struct ProgramResult {
    int code;
    std::string out, err;
};
inline void PrintTo(const ProgramResult& result, std::ostream* stream) {
    *stream << "exit code " << result.code << "\n" << result.out << result.err;
}

/// Match a ProgramResult with this exit code (0 for prints()), whose standard error or output matches all of `words`.
inline auto exits(int code) { return ::testing::Field("code", &ProgramResult::code, code); }
template <class... Words>
auto exits(int code, const Words&... words) {
    return AllOf(exits(code), ::testing::Field("err", &ProgramResult::err, AllOf(words...)));
}
template <class... Words>
auto prints_with(int code, const Words&... words) {
    return AllOf(exits(code), ::testing::Field("out", &ProgramResult::out, AllOf(words...)));
}
template <class... Words>
auto prints(const Words&... words) {
    return prints_with(0, words...);
}

/// Runs the built program in `folder` through a shell, so `arguments` must be quoted as a shell needs.
inline ProgramResult run_gibench(const std::string& arguments, const std::string& folder) {
    const std::string command = "cd '" + folder + "' && '" + program_path() + "' " + arguments + " >.out 2>.err";
    const int status = std::system(command.c_str());
    ProgramResult result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(folder + "/.out"),
                         read_file(folder + "/.err")};
    std::filesystem::remove(folder + "/.out");
    std::filesystem::remove(folder + "/.err");
    return result;
}

}  // namespace gib::test
