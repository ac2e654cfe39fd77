#include "common/xml/scene_spectrum.h"

#include "common/color/cie.h"
#include "common/core/files.h"
#include "common/core/reject.h"
#include "common/core/text_cursor.h"

#include <fmt/format.h>
#include <algorithm>

namespace gib {

namespace {

/// The use of a colour: its property and the range of its values.
struct Purpose {
    const std::string& property;
    ColorRange range;
    Illuminant illuminant;  ///< light under which the colour is seen
    const XmlIds& ids;      ///< takes the warnings
};

/// The colour in float. Throws InputError for a channel out of range.
Color checked(const Colord& rgb, const Purpose& purpose, const SourceLocation& where) {
    for (const double channel : rgb)
        check_color_value(channel, purpose.range, purpose.property, where);
    return rgb.cast<float>();
}

Color color_of(const Spectrum& spectrum, const Purpose& purpose, const SourceLocation& where) {
    Colord rgb = rgb_of_spectrum(spectrum, purpose.illuminant).max(0.0);
    if (purpose.range == ColorRange::unit) rgb = rgb.min(1.0);
    return checked(rgb, purpose, where);
}

class SampleList {
public:
    explicit SampleList(const Purpose& purpose) : purpose_(purpose) {}

    void add(double wavelength, double value, const SourceLocation& where) {
        auto& wavelengths = samples_.wavelengths;
        for (const double x : {wavelength, value})
            if (!std::isfinite(x)) reject(where, "bad number '{}'", x);
        if (!wavelengths.empty() && wavelength <= wavelengths.back())
            reject(where, "the wavelengths must increase: {} follows {}", wavelength, wavelengths.back());
        // Whether a negative value is noise depends on the highest value.
        const bool waits = purpose_.range == ColorRange::non_negative && value < 0;
        if (waits && value < lowest_) {
            lowest_ = value;
            place_of_lowest_ = where;
        }
        check_color_value(waits ? 0 : value, purpose_.range, purpose_.property, where);
        wavelengths.push_back(wavelength);
        samples_.values.push_back(value);
    }

    Color color(const SourceLocation& where) {
        auto& values = samples_.values;
        if (lowest_ < 0) {
            if (!is_noise(lowest_, *std::max_element(values.begin(), values.end()), purpose_.range))
                check_color_value(lowest_, purpose_.range, purpose_.property, place_of_lowest_);
            purpose_.ids.warn(place_of_lowest_,
                              fmt::format("'{}' must not be negative: {} counts as 0", purpose_.property, lowest_));
            for (double& value : values)
                value = std::max(value, 0.0);
        }
        if (samples_.values.size() < 2)
            reject(where, "a spectrum needs two wavelengths or more, found {}", samples_.values.size());
        return color_of(samples_, purpose_, where);
    }

private:
    const Purpose& purpose_;
    SampledSpectrum samples_;
    double lowest_ = 0;  ///< lowest negative value
    SourceLocation place_of_lowest_;
};

/// A part of an attribute's value, as an attribute at the same place.
XmlAttribute part(const XmlAttribute& attribute, std::string text) {
    return {attribute.name, std::move(text), attribute.where};
}

Color parse_list(const XmlAttribute& attribute, const Purpose& purpose) {
    SampleList list(purpose);
    for (const std::string& pair : words_of(attribute.value)) {
        const std::size_t colon = pair.find(':');
        if (colon == pair.npos)
            reject(attribute.where, "bad spectrum '{}': expected wavelength:value, as in 400:0.1", pair);
        list.add(parse_number(part(attribute, pair.substr(0, colon))),
                 parse_number(part(attribute, pair.substr(colon + 1))), attribute.where);
    }
    return list.color(attribute.where);
}

Color parse_file(const std::string& path, const Purpose& purpose) {
    const std::string text = read_file(path);
    TextCursor cursor(text, path);
    SampleList list(purpose);
    for (cursor.skip_space(); !cursor.at_end(); cursor.skip_space()) {
        if (cursor.peek() != '#') {
            const SourceLocation where = cursor.location();
            const double wavelength = cursor.number(), value = cursor.number();
            list.add(wavelength, value, where);
            cursor.skip_blanks();
            if (!cursor.at_line_end() && cursor.peek() != '#')
                throw InputError(cursor.location(), "a line has two numbers: a wavelength and a value");
        }
        cursor.next_line();
    }
    return list.color({path, 0, 0});
}

/// The colour of a value that is the same at all wavelengths.
Color parse_constant(const XmlAttribute& attribute, const Purpose& purpose) {
    const double value = parse_number(attribute);
    check_color_value(value, purpose.range, purpose.property, attribute.where);
    const Colord xyz = Colord::Constant(value);
    return checked(purpose.range == ColorRange::emission ? rgb_of_xyz(xyz) : xyz, purpose, attribute.where);
}

double required_number(Properties& properties, const std::string& name) {
    properties.require(name);
    return *properties.number(name);
}

/// The numbers of a <string>, as an attribute at their place.
XmlAttribute required_list(Properties& properties, const std::string& name) {
    return {"value", properties.required_string(name), properties.where(name)};
}

Color parse_regular(Properties& properties, const Purpose& purpose) {
    const double first = required_number(properties, "wavelength_min"),
                 last = required_number(properties, "wavelength_max");
    const XmlAttribute attribute = required_list(properties, "values");
    const std::vector<double> values = parse_numbers(attribute);
    SampleList list(purpose);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double t = values.size() < 2 ? 0.0 : static_cast<double>(i) / static_cast<double>(values.size() - 1);
        list.add((1 - t) * first + t * last, values[i], attribute.where);
    }
    return list.color(attribute.where);
}

Color parse_irregular(Properties& properties, const Purpose& purpose) {
    const XmlAttribute attribute = required_list(properties, "values");
    const std::vector<double> wavelengths = parse_numbers(required_list(properties, "wavelengths")),
                              values = parse_numbers(attribute);
    if (wavelengths.size() != values.size())
        reject(attribute.where, "found {} values at {} wavelengths", values.size(), wavelengths.size());
    SampleList list(purpose);
    for (std::size_t i = 0; i < values.size(); ++i)
        list.add(wavelengths[i], values[i], attribute.where);
    return list.color(attribute.where);
}

/// Planck's law with the constants of the SI (2019): radiance [W/(m^2 sr nm)] at a wavelength [nm].
double planck(double wavelength, double temperature) {
    constexpr double c = 299792458, h = 6.62607015e-34, k = 1.380649e-23;
    const double metres = wavelength * 1e-9;
    return 1e-9 * 2 * h * c * c / (std::pow(metres, 5) * std::expm1(h * c / (metres * k * temperature)));
}

Color parse_blackbody(Properties& properties, const Purpose& purpose) {
    const SourceLocation& where = properties.element().where;
    if (purpose.range != ColorRange::emission)
        reject(where, "'{}' cannot be a blackbody: only an emission can", purpose.property);
    properties.require("temperature");
    const double temperature = properties.positive("temperature", 0);
    const double first = properties.number("wavelength_min", shortest_wavelength),
                 last = properties.number("wavelength_max", longest_wavelength);
    const double scale = properties.not_negative("scale", 1);
    const auto spectrum = [&](double wavelength) {
        return wavelength >= first && wavelength <= last ? scale * planck(wavelength, temperature) : 0.0;
    };
    return color_of(spectrum, purpose, where);
}

/// A colour under D65, the white of RGB.
Color parse_d65(Properties& properties, const Purpose& purpose) {
    const double scale = properties.number("scale", 1);
    const Color color = properties.rgb("color", 1, ColorRange::non_negative);
    return checked(color.cast<double>() * scale, purpose, properties.where("scale"));
}

Color parse_srgb(Properties& properties, const Purpose& purpose) {
    properties.require("color");
    return properties.rgb("color", 1, purpose.range);
}

/// A grey. The range of wavelengths has no effect in RGB.
Color parse_uniform(Properties& properties, const Purpose& purpose) {
    properties.number("wavelength_min");
    properties.number("wavelength_max");
    const double value = required_number(properties, "value");
    return checked(Colord::Constant(value), purpose, properties.where("value"));
}

Color parse_plugin(const XmlElement& element, const XmlIds& ids, const Purpose& purpose) {
    Properties properties(element, ids);
    const std::string& type = properties.plugin({"uniform", "regular", "irregular", "srgb", "d65", "blackbody"});
    const auto parse = [&]() -> Color {
        if (type == "regular") return parse_regular(properties, purpose);
        if (type == "irregular") return parse_irregular(properties, purpose);
        if (type == "blackbody") return parse_blackbody(properties, purpose);
        if (type == "d65") return parse_d65(properties, purpose);
        if (type == "srgb") return parse_srgb(properties, purpose);
        return parse_uniform(properties, purpose);
    };
    const Color color = parse();
    properties.finish();
    return color;
}

}  // namespace

Color parse_spectrum(const XmlElement& element, const XmlIds& ids, const std::string& name, ColorRange range) {
    const bool as_it_is = range == ColorRange::emission || element.old;
    const Purpose purpose{name, range, as_it_is ? Illuminant::none : Illuminant::d65, ids};
    if (element.find("type")) return parse_plugin(element, ids, purpose);
    element.check_attributes({"name", "value", "filename"});
    const XmlAttribute* file = element.find("filename");
    if (file && element.find("value")) throw InputError(file->where, "give either 'value' or 'filename'");
    if (file) return parse_file(file->value, purpose);
    const XmlAttribute& value = element.required("value");
    if (value.value.starts_with('#')) {
        const auto channels = parse_linear_channels(value);
        return checked(Colord(channels[0], channels[1], channels[2]), purpose, value.where);
    }
    const auto words = words_of(value.value);
    const bool constant = words.size() == 1 && words[0].find(':') == std::string::npos;
    return constant ? parse_constant(part(value, words[0]), purpose) : parse_list(value, purpose);
}

Color color_property(Properties& properties, const std::string& name, float fallback, ColorRange range) {
    if (const XmlElement* spectrum = properties.spectrum(name))
        return parse_spectrum(*spectrum, properties.ids(), name, range);
    return properties.rgb(name, fallback, range);
}

}  // namespace gib
