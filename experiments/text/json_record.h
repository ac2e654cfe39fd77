#pragma once
// Records as JSON objects: a struct lists its members once, and is written and read by that list.
//
// Reads JSON files that gibench wrote and that may have been damaged since.

#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>

namespace gib {

/// JSON has neither NaN nor infinity: values that are not finite are written as null, and null is read as NaN.
template <typename Json = nlohmann::json>
Json number_to_json(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
inline double number_from_json(const nlohmann::json& j) {
    return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

/// A member of a record with its name in JSON.
template <typename T>
struct JsonField {
    const char* name;
    T& value;
};
template <typename T>
JsonField(const char*, T&) -> JsonField<T>;

/// A record, which may be const, of this type. For it, json_fields(record) returns a tuple of JsonField.
template <typename T, typename Record>
concept RecordOf = std::same_as<std::remove_const_t<T>, Record>;
template <typename T>
concept JsonRecord = requires(T& record) {
    json_fields(record);
};

template <typename Json, typename T>
void write_json_field(Json& j, const JsonField<T>& field) {
    if constexpr (std::is_same_v<std::remove_const_t<T>, double>) j[field.name] = number_to_json<Json>(field.value);
    else j[field.name] = field.value;
}
template <typename T>
void read_json_field(const nlohmann::json& j, const JsonField<T>& field) {
    if constexpr (std::is_same_v<T, double>) field.value = number_from_json(j.at(field.name));
    else j.at(field.name).get_to(field.value);
}

/// The file's content. Throws nlohmann::json::parse_error if it is not JSON, InputError if it cannot be read.
nlohmann::json read_json(const std::string& path);

/// Writes a record with SHA-1 of its text. The text is the same for a record that was written and read again, because
/// numbers are read exactly and keys are sorted.
void write_sealed_json(const std::string& path, nlohmann::json record);
/// The record in such a file; null if its content is not what its digest says. Throws nlohmann::json::exception if it
/// holds none, and InputError.
nlohmann::json read_sealed_json(const std::string& path);

}  // namespace gib

template <gib::JsonRecord Record>
struct nlohmann::adl_serializer<Record, void> {
    template <typename Json>
    static void to_json(Json& j, const Record& record) {
        j = Json::object();
        std::apply([&](const auto&... fields) { (gib::write_json_field(j, fields), ...); }, json_fields(record));
    }
    static void from_json(const json& j, Record& record) {
        std::apply([&](const auto&... fields) { (gib::read_json_field(j, fields), ...); }, json_fields(record));
    }
};

/// An empty value is null.
template <typename T>
struct nlohmann::adl_serializer<std::optional<T>, void> {
    template <typename Json>
    static void to_json(Json& j, const std::optional<T>& value) {
        if (value) j = *value;
        else j = nullptr;
    }
    static void from_json(const json& j, std::optional<T>& value) {
        value = j.is_null() ? std::nullopt : std::optional(j.get<T>());
    }
};
