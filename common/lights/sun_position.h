#pragma once
// Where the sun stands at a time and a place.

namespace gib {

/// A local time and a place; the defaults are Mitsuba's: Tokyo, 10 July 2010, 15:00.
struct TimeAndPlace {
    int year = 2010, month = 7, day = 10;  ///< date in the Gregorian calendar
    double hour = 15, minute = 0, second = 0;
    double timezone = 9;                              ///< hours ahead of universal time
    double latitude = 35.6894, longitude = 139.6917;  ///< north and east [degrees]
};

/// Whether there is such a day.
bool is_date(const TimeAndPlace& at);

struct SunAngles {
    double theta;    ///< angle from the zenith [rad]; above pi / 2 the sun is below the horizon
    double azimuth;  ///< angle from north towards east [rad]
};

/// Source: Blanco-Muriel, Alarcon-Padilla, Lopez-Moratalla and Lara-Coira 2001, "Computing the Solar Vector" (Solar
/// Energy 70), whose errors are below 0.01 degrees from 1999 to 2015. Refraction by the atmosphere is left out.
SunAngles sun_position(const TimeAndPlace& at);

}  // namespace gib
