#pragma once
// Fills Mustache templates (kainjow's library).

#include <kainjow/mustache.hpp>

#include <initializer_list>
#include <string>
#include <string_view>

namespace gib {

/// The template with the data in place; `escape` writes every text.
std::string filled(std::string_view page, const kainjow::mustache::data& values,
                   std::string (*escape)(std::string_view));

/// Embedded scripts (embedded_files.h) as a list of texts that may stand in <script> elements.
kainjow::mustache::list embedded_scripts(std::initializer_list<std::string_view> names);

}  // namespace gib
