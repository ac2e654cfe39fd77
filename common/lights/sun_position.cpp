#include "common/lights/sun_position.h"

#include <chrono>
#include <cmath>
#include <numbers>

namespace gib {

namespace {

constexpr double radians = std::numbers::pi / 180;

std::chrono::year_month_day date_of(const TimeAndPlace& at) {
    return {std::chrono::year(at.year), std::chrono::month(static_cast<unsigned>(at.month)),
            std::chrono::day(static_cast<unsigned>(at.day))};
}

/// Right ascension and declination [rad].
struct Celestial {
    double ascension, declination;
};

/// `days`: since noon of 1 January 2000, universal time.
Celestial celestial_position(double days) {
    const double node = 2.1429 - 0.0010394594 * days;
    const double anomaly = 6.2400600 + 0.0172019699 * days;
    const double longitude = 4.8950630 + 0.017202791698 * days + 0.03341607 * std::sin(anomaly) +
                             0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(node);
    const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(node);
    return {std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude)),
            std::asin(std::sin(obliquity) * std::sin(longitude))};
}

}  // namespace

bool is_date(const TimeAndPlace& at) { return date_of(at).ok(); }

SunAngles sun_position(const TimeAndPlace& at) {
    using namespace std::chrono;
    const double hours = at.hour + (at.minute + at.second / 60) / 60 - at.timezone;  // universal time
    const auto whole_days = static_cast<double>((sys_days(date_of(at)) - sys_days(year(2000) / January / 1)).count());
    const double days = whole_days + (hours - 12) / 24;
    const Celestial sun = celestial_position(days);
    const double sidereal_hours = 6.6974243242 + 0.0657098283 * days + hours;
    const double hour_angle = radians * (15 * sidereal_hours + at.longitude) - sun.ascension;
    const double latitude = radians * at.latitude;
    const double theta = std::acos(std::cos(latitude) * std::cos(hour_angle) * std::cos(sun.declination) +
                                   std::sin(sun.declination) * std::sin(latitude));
    const double azimuth = std::atan2(-std::sin(hour_angle), std::tan(sun.declination) * std::cos(latitude) -
                                                                 std::sin(latitude) * std::cos(hour_angle));
    // Parallax: the observer stands on the earth's surface, not at its centre.
    constexpr double earth_radius = 6371.01, distance = 149597890;  // [km]
    return {theta + earth_radius / distance * std::sin(theta), azimuth};
}

}  // namespace gib
