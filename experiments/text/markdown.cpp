#include "experiments/text/markdown.h"

namespace gib {

std::string markdown_text(std::string_view text) {
    std::string line;
    for (const char c : text) {
        if (c == '|') line += '\\';
        line += c == '\n' || c == '\r' ? ' ' : c;
    }
    return line;
}

}  // namespace gib
