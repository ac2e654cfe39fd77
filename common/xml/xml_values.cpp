#include "common/xml/xml_values.h"

#include "common/color/srgb.h"
#include "common/core/float_traps.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <system_error>

namespace gib {

namespace {

constexpr std::string_view blanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(blanks);
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_plus(std::string_view text) { return text.substr(text.starts_with('+') ? 1 : 0); }

double finite_number(std::string_view text, const XmlAttribute& attribute) {
    const auto value = number_from<double>(without_plus(text));
    if (!value || !std::isfinite(*value)) reject(attribute.where, "bad number '{}'", text);
    return *value;
}

Vec3d three_numbers(const XmlAttribute& attribute) {
    const auto numbers = parse_numbers(attribute);
    if (numbers.size() != 3) reject(attribute.where, "expected three numbers, found {}", numbers.size());
    return {numbers[0], numbers[1], numbers[2]};
}

/// The length of a vector, without overflow or underflow on the way.
double length_of(const Vec3d& v) { return std::hypot(v.x(), v.y(), v.z()); }

Mat4d with_linear_part(const Eigen::Matrix3d& linear) {
    Mat4d m = Mat4d::Identity();
    m.topLeftCorner<3, 3>() = linear;
    return m;
}

Mat4d parse_translate(const XmlElement& element) {
    element.check_attributes({"x", "y", "z", "value"});
    Mat4d m = Mat4d::Identity();
    m.topRightCorner<3, 1>() = parse_vector(element, 0);
    return m;
}

Mat4d parse_scale(const XmlElement& element) {
    element.check_attributes({"x", "y", "z", "value"});
    return with_linear_part(parse_vector(element, 1).asDiagonal());
}

Mat4d parse_rotate(const XmlElement& element) {
    element.check_attributes({"x", "y", "z", "value", "angle"});
    const Vec3d axis = parse_vector(element, 0);
    const double angle = parse_number(element.required("angle")) * std::numbers::pi / 180;
    const double length = length_of(axis);
    if (length == 0 && angle == 0) return Mat4d::Identity();
    if (length == 0) throw InputError(element.where, "the rotation's axis is zero");
    return with_linear_part(Eigen::AngleAxisd(angle, axis / length).toRotationMatrix());
}

/// A camera in Mitsuba's convention: x left, y up, z forward. Without `up`, any direction across the view is taken.
Mat4d parse_lookat(const XmlElement& element) {
    element.check_attributes({"origin", "target", "up"});
    const Vec3d origin = three_numbers(element.required("origin"));
    const Vec3d forward = three_numbers(element.required("target")) - origin;
    if (length_of(forward) == 0) throw InputError(element.where, "lookat: origin and target are the same point");
    const Vec3d dir = forward / length_of(forward);
    Vec3d up = element.find("up") ? three_numbers(*element.find("up")) : Vec3d(0, 0, 0);
    if (up.isZero(0)) {
        // The first axis of the basis of Duff et al. 2017 (see math.h), which is what Mitsuba takes.
        const double sign = std::copysign(1.0, dir.z()), a = -1 / (sign + dir.z());
        up = Vec3d(1 + sign * sqr(dir.x()) * a, sign * dir.x() * dir.y() * a, -sign * dir.x());
    }
    const Vec3d left = (up / length_of(up)).cross(dir);
    if (left.norm() < 1e-12) throw InputError(element.where, "lookat: 'up' is parallel to the view direction");
    Mat4d m = Mat4d::Identity();
    m.block<3, 1>(0, 0) = left.normalized();
    m.block<3, 1>(0, 1) = dir.cross(left.normalized());
    m.block<3, 1>(0, 2) = dir;
    m.block<3, 1>(0, 3) = origin;
    return m;
}

Mat4d parse_matrix(const XmlElement& element) {
    element.check_attributes({"value"});
    const XmlAttribute& value = element.required("value");
    const auto numbers = parse_numbers(value);
    if (numbers.size() != 9 && numbers.size() != 16)
        reject(value.where, "a matrix has 9 or 16 numbers, found {}", numbers.size());
    if (numbers.size() == 9)
        return with_linear_part(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data()));
    const Mat4d m = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
    if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw InputError(value.where, "the last row of a transform must be 0 0 0 1");
    return m;
}

Mat4d parse_operation(const XmlElement& element) {
    element.check_no_children();
    if (element.tag == "translate") return parse_translate(element);
    if (element.tag == "rotate") return parse_rotate(element);
    if (element.tag == "scale") return parse_scale(element);
    if (element.tag == "lookat") return parse_lookat(element);
    if (element.tag == "matrix") return parse_matrix(element);
    reject(element.where,
           "<transform> cannot hold <{}>; it takes: translate, rotate, scale, "
           "lookat, matrix",
           element.tag);
}

/// Whether the columns span less than three dimensions. The test is relative to their lengths, because a small
/// uniform scale is not singular.
bool singular(const Mat4d& m) {
    if (!std::all_of(m.data(), m.data() + m.size(), [](double x) { return std::isfinite(x); })) return true;
    Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
    for (int i = 0; i < 3; ++i) {
        const double length = length_of(linear.col(i));
        if (length == 0 || !std::isfinite(length)) return true;
        linear.col(i) /= length;
    }
    return std::abs(linear.determinant()) < 1e-12;
}

}  // namespace

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    return text;
}

std::vector<std::string> words_of(std::string_view text) {
    constexpr std::string_view separators = " \t\r\n,";
    std::vector<std::string> words;
    for (std::size_t begin = text.find_first_not_of(separators); begin != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        words.emplace_back(text.substr(begin, end - begin));
        begin = text.find_first_not_of(separators, end);
    }
    return words;
}

double parse_number(const XmlAttribute& attribute) { return finite_number(trimmed(attribute.value), attribute); }

std::vector<double> parse_numbers(const XmlAttribute& attribute) {
    std::vector<double> numbers;
    for (const auto& word : words_of(attribute.value))
        numbers.push_back(finite_number(word, attribute));
    return numbers;
}

std::vector<double> parse_channels(const XmlAttribute& attribute) {
    const std::string_view text = trimmed(attribute.value);
    if (!text.starts_with('#')) return parse_numbers(attribute);
    std::vector<double> channels;
    for (std::size_t i = 1; i + 1 < text.size(); i += 2) {
        unsigned byte = 0;
        const char* first = text.data() + i;
        if (std::from_chars(first, first + 2, byte, 16).ptr != first + 2) break;
        channels.push_back(byte / 255.0);
    }
    if (channels.size() != 3 || text.size() != 7) reject(attribute.where, "bad colour '{}': expected #rrggbb", text);
    return channels;
}

std::vector<double> parse_linear_channels(const XmlAttribute& attribute) {
    std::vector<double> channels = parse_channels(attribute);
    if (trimmed(attribute.value).starts_with('#'))
        for (double& channel : channels)
            channel = static_cast<double>(linear_from_srgb(static_cast<float>(channel)));
    return channels;
}

std::int64_t parse_integer(const XmlAttribute& attribute) {
    const std::string_view digits = without_plus(trimmed(attribute.value));
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end != digits.data() + digits.size() || error == std::errc::invalid_argument)
        reject(attribute.where, "bad number '{}': expected an integer", attribute.value);
    if (error == std::errc()) return value;
    using Limits = std::numeric_limits<std::int64_t>;
    return digits.starts_with('-') ? Limits::min() : Limits::max();
}

bool parse_boolean(const XmlAttribute& attribute) {
    const std::string text = lower_case(attribute.value);
    if (text != "true" && text != "false") reject(attribute.where, "'{}' is neither true nor false", attribute.value);
    return text == "true";
}

Vec3d parse_vector(const XmlElement& element, std::optional<double> fallback) {
    const XmlAttribute* axes[] = {element.find("x"), element.find("y"), element.find("z")};
    if (const XmlAttribute* value = element.find("value")) {
        for (const auto* axis : axes)
            if (axis) throw InputError(axis->where, "give either 'value' or 'x', 'y' and 'z'");
        const auto numbers = parse_numbers(*value);
        if (numbers.size() == 1) return Vec3d::Constant(numbers[0]);
        if (numbers.size() != 3) reject(value->where, "expected one or three numbers, found {}", numbers.size());
        return {numbers[0], numbers[1], numbers[2]};
    }
    Vec3d v;
    constexpr std::string_view names[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i)
        v[i] = axes[i] || !fallback ? parse_number(axes[i] ? *axes[i] : element.required(names[i])) : *fallback;
    return v;
}

Mat4d parse_transform(const XmlElement& element) {
    const FloatTrapsPaused paused;  // overflows are refused below, or once the whole scene is known
    Mat4d transform = Mat4d::Identity();
    for (const auto& operation : element.children)
        transform = parse_operation(operation) * transform;
    if (singular(transform)) throw InputError(element.where, "the transform is singular");
    return transform;
}

}  // namespace gib
