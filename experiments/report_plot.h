#pragma once
// A plot of error against time as inline SVG, both axes logarithmic; its colours follow the page's light or dark
// scheme.

#include <string>
#include <vector>

namespace gib {

struct PlotPoint {
    double x, y;  ///< both above 0; others are left out
};

struct PlotLine {
    std::string name;
    std::vector<PlotPoint> points;
};

/// The colour of line `index`, legible on light and dark ground; they repeat after ten.
std::string line_color(std::size_t index);

/// An <svg> of the lines with axes, ticks and labels; empty if no line has a point. The legend is the page's.
std::string log_log_plot(const std::vector<PlotLine>& lines, const std::string& x_label, const std::string& y_label);

/// Text for HTML.
std::string html_escape(const std::string& text);

}  // namespace gib
