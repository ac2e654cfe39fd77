// Tests of the sun's position against the course of the sun over a day and a year.

#include "common/lights/sun_position.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gib::test::sun_position_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// The highest sun of a day, from one minute to the next.
struct Noon {
    double elevation = -90, azimuth = 0, hour = 0;  ///< [degrees], local time
};
Noon noon_of(TimeAndPlace at) {
    Noon noon;
    for (int minute = 0; minute < 24 * 60; ++minute) {
        at.hour = minute / 60;
        at.minute = minute % 60;
        const SunAngles sun = sun_position(at);
        const double elevation = 90 - sun.theta / degree;
        if (elevation > noon.elevation) noon = {elevation, sun.azimuth / degree, minute / 60.0};
    }
    return noon;
}

// On the solstices the sun stands over the latitudes 23.44 and -23.44 degrees, on the equinoxes over the equator. The
// tolerance is the change of its declination within half a day.
TEST(SunPosition, NoonOfSolsticesAndEquinoxes) {
    TimeAndPlace at{.year = 2010, .month = 6, .day = 21, .timezone = 0, .latitude = 51.4779, .longitude = 0};
    EXPECT_NEAR(noon_of(at).elevation, 90 - 51.4779 + 23.44, 0.01);
    EXPECT_NEAR(std::abs(noon_of(at).azimuth), 180, 1) << "in the south";
    at.latitude = -35;
    EXPECT_NEAR(noon_of(at).elevation, 90 - 35 - 23.44, 0.01);
    EXPECT_NEAR(noon_of(at).azimuth, 0, 1) << "in the north";
    at.month = 12;
    EXPECT_NEAR(noon_of(at).elevation, 90 - 35 + 23.44, 0.01);
    at = {.year = 2010, .month = 3, .day = 20, .timezone = 0, .latitude = 0, .longitude = 0};
    EXPECT_NEAR(noon_of(at).elevation, 90, 0.25);
}

// The sun is early by 16.4 minutes on 3 November and late by 14.2 on 11 February (the equation of time), and 4 minutes
// later for each degree to the west of the meridian of the time zone.
TEST(SunPosition, NoonFollowsTheEquationOfTimeAndTheLongitude) {
    TimeAndPlace at{.year = 2010, .month = 11, .day = 3, .timezone = 0, .latitude = 40, .longitude = 0};
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), -16.4, 1);
    at.month = 2, at.day = 11;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2, 1);
    at.longitude = -10;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2 + 40, 1);
    at.timezone = -1;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2 + 40 - 60, 1);
}

TEST(SunPosition, RisesInTheEastAndSetsInTheWest) {
    TimeAndPlace at{.year = 2010, .month = 3, .day = 20, .hour = 6.13, .timezone = 0, .latitude = 30, .longitude = 0};
    EXPECT_NEAR(sun_position(at).azimuth / degree, 90, 1);
    EXPECT_NEAR(sun_position(at).theta / degree, 90, 1);
    at.hour = 18.13;
    EXPECT_NEAR(std::fmod(sun_position(at).azimuth / degree + 360, 360), 270, 1);
    EXPECT_NEAR(sun_position(at).theta / degree, 90, 1);
}

TEST(SunPosition, KnowsTheCalendar) {
    EXPECT_TRUE(is_date({.year = 2012, .month = 2, .day = 29}));
    EXPECT_FALSE(is_date({.year = 2010, .month = 2, .day = 29}));
    EXPECT_FALSE(is_date({.month = 4, .day = 31}));
}

}  // namespace
}  // namespace gib::test::sun_position_test
