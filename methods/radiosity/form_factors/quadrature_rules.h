#pragma once
// Nodes and weights of quadrature rules on [-1, 1].

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

namespace gib {

struct QuadratureNode {
    double x, weight;
};

/// The Gauss-Legendre rule of N nodes in rising order, exact for polynomials of degree 2 N - 1.
template <std::size_t N>
constexpr std::array<QuadratureNode, N> gauss_legendre() {
    struct Values {
        double p, derivative;
    };
    const auto legendre = [](double x) {
        double previous = 1, p = x;
        for (std::size_t k = 2; k <= N; ++k) {
            const auto n = static_cast<double>(k);
            const double next = ((2 * n - 1) * x * p - (n - 1) * previous) / n;
            previous = p;
            p = next;
        }
        return Values{p, static_cast<double>(N) * (previous - x * p) / (1 - x * x)};
    };
    // Between two neighbouring nodes of the rule with one node less lies one node of this rule.
    std::array<double, N + 1> bounds{};
    bounds[0] = -1;
    bounds[N] = 1;
    if constexpr (N > 1) {
        const auto inner = gauss_legendre<N - 1>();
        for (std::size_t i = 0; i + 1 < N; ++i)
            bounds[i + 1] = inner[i].x;
    }
    std::array<QuadratureNode, N> nodes{};
    for (std::size_t i = 0; i < N; ++i) {
        double lower = bounds[i], upper = bounds[i + 1];
        const bool rises = legendre(upper == 1 ? upper - 1e-12 : upper).p > 0;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (lower + upper);
            ((legendre(middle).p > 0) == rises ? upper : lower) = middle;
        }
        const double x = 0.5 * (lower + upper), derivative = legendre(x).derivative;
        nodes[i] = {x, 2 / ((1 - x * x) * derivative * derivative)};
    }
    return nodes;
}

inline constexpr std::size_t max_gauss_nodes = 8;

/// The rule of n nodes, 1 <= n <= max_gauss_nodes.
inline std::span<const QuadratureNode> gauss_rule(std::size_t n) {
    static constexpr auto rules = []<std::size_t... I>(std::index_sequence<I...>) {
        std::array<std::array<QuadratureNode, max_gauss_nodes>, sizeof...(I)> all{};
        (std::ranges::copy(gauss_legendre<I + 1>(), all[I].begin()), ...);
        return all;
    }
    (std::make_index_sequence<max_gauss_nodes>());
    return {rules[n - 1].data(), n};
}

/// A node of Kronrod's extension of the Gauss-Legendre rule of 7 nodes. The rule is symmetric around 0, so only nodes
/// with x >= 0 are listed. Source: QUADPACK, qk15 (Piessens et al. 1983).
struct KronrodNode {
    double x, weight;
    double gauss_weight;  ///< 0 at the nodes that Gauss's rule lacks
};
inline constexpr std::array<KronrodNode, 8> kronrod_15 = {{
    {0.991455371120812639206854697526329, 0.022935322010529224963732008058970, 0},
    {0.949107912342758524526189684047851, 0.063092092629978553290700663189204, 0.129484966168869693270611432679082},
    {0.864864423359769072789712788640926, 0.104790010322250183839876322541518, 0},
    {0.741531185599394439863864773280788, 0.140653259715525918745189590510238, 0.279705391489276667901467771423780},
    {0.586087235467691130294144691258, 0.169004726639267902826583426598550, 0},
    {0.405845151377397166906606412076961, 0.190350578064785409913256402421014, 0.381830050505118944950369775488975},
    {0.207784955007898467600689403773245, 0.204432940075298892414161999234649, 0},
    {0, 0.209482141084727828012999174891714, 0.417959183673469387755102040816327},
}};

}  // namespace gib
