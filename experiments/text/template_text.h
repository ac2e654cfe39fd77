#pragma once
// Fills Mustache templates (kainjow's library).

#include <kainjow/mustache.hpp>

#include <string>
#include <string_view>

namespace gib {

/// The template with the data in place; `escape` writes every text.
std::string filled(std::string_view page, const kainjow::mustache::data& values,
                   std::string (*escape)(std::string_view));

}  // namespace gib
