#include "experiments/report_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gib {

namespace {

// Units of the SVG's own coordinates; the page scales it to its width.
constexpr double width = 760, height = 420, left = 70, right = 20, top = 16, bottom = 56;

/// Positions on one logarithmic axis.
class LogAxis {
public:
    LogAxis(double smallest, double largest, double from, double to) : from_(from), to_(to) {
        lower_ = std::log10(smallest);
        upper_ = std::log10(largest);
        const double margin = std::max(0.05 * (upper_ - lower_), 0.05);
        lower_ -= margin;
        upper_ += margin;
    }
    double position(double value) const {
        return from_ + (std::log10(value) - lower_) / (upper_ - lower_) * (to_ - from_);
    }

    /// Powers of ten, and 2 and 5 times them where there are few.
    std::vector<double> ticks() const {
        std::vector<double> ticks;
        const bool dense = upper_ - lower_ < 3;
        for (int decade = static_cast<int>(std::floor(lower_)); decade <= static_cast<int>(std::ceil(upper_)); ++decade)
            for (const double digit : {1.0, 2.0, 5.0}) {
                if (digit != 1.0 && !dense) continue;
                const double value = digit * std::pow(10.0, decade);
                if (std::log10(value) >= lower_ && std::log10(value) <= upper_) ticks.push_back(value);
            }
        return ticks;
    }

private:
    double lower_, upper_, from_, to_;
};

bool drawable(const PlotPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0; }

std::string axes(const LogAxis& x, const LogAxis& y, const std::string& x_label, const std::string& y_label) {
    std::string svg;
    for (const double tick : x.ticks()) {
        const double at = x.position(tick);
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\"/>"
            "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g}</text>\n",
            at, top, height - bottom, height - bottom + 20, tick);
    }
    for (const double tick : y.ticks()) {
        const double at = y.position(tick);
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\"/>"
            "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>\n",
            at, left, width - right, left - 8, at + 5, tick);
    }
    svg += fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", left, top,
                       width - left - right, height - top - bottom);
    svg += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       (left + width - right) / 2, height - 10, html_escape(x_label));
    svg += fmt::format(
        "<text class=\"label\" transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
        (top + height - bottom) / 2, html_escape(y_label));
    return svg;
}

std::string polyline(const PlotLine& line, const LogAxis& x, const LogAxis& y, const std::string& color) {
    std::string points, dots;
    PlotPoint last{0, 0};
    for (const auto& p : line.points) {
        if (!drawable(p)) continue;
        points += fmt::format("{:.1f},{:.1f} ", x.position(p.x), y.position(p.y));
        dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>", x.position(p.x), y.position(p.y));
        last = p;
    }
    if (points.empty()) return "";
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\"/>", x.position(last.x), y.position(last.y));
    return fmt::format(
        "<g fill=\"{0}\"><title>{1}</title><polyline points=\"{2}\" fill=\"none\" stroke=\"{0}\" "
        "stroke-width=\"2\"/>{3}</g>\n",
        color, html_escape(line.name), points, dots);
}

}  // namespace

std::string line_color(std::size_t index) {
    constexpr std::array colors = {"#3b82f6", "#f97316", "#10b981", "#e11d48", "#a855f7",
                                   "#ca8a04", "#0891b2", "#65a30d", "#db2777", "#64748b"};
    return colors[index % colors.size()];
}

std::string log_log_plot(const std::vector<PlotLine>& lines, const std::string& x_label, const std::string& y_label) {
    PlotPoint smallest{INFINITY, INFINITY}, largest{0, 0};
    for (const auto& line : lines)
        for (const auto& p : line.points) {
            if (!drawable(p)) continue;
            smallest = {std::min(smallest.x, p.x), std::min(smallest.y, p.y)};
            largest = {std::max(largest.x, p.x), std::max(largest.y, p.y)};
        }
    if (largest.x <= 0) return "";
    const LogAxis x(smallest.x, largest.x, left, width - right);
    const LogAxis y(smallest.y, largest.y, height - bottom, top);
    std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{} against {}\">\n", width,
                                  height, html_escape(y_label), html_escape(x_label));
    svg += axes(x, y, x_label, y_label);
    for (std::size_t i = 0; i < lines.size(); ++i)
        svg += polyline(lines[i], x, y, line_color(i));
    return svg + "</svg>\n";
}

std::string html_escape(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&') escaped += "&amp;";
        else if (c == '<') escaped += "&lt;";
        else if (c == '>') escaped += "&gt;";
        else if (c == '"') escaped += "&quot;";
        else escaped += c;
    }
    return escaped;
}

}  // namespace gib
