#include "methods/radiosity/solution.h"

#include "common/core/error.h"

#include <Eigen/Cholesky>

namespace gib {

namespace {

[[noreturn]] void refuse_to_reflect_for_ever() {
    throw InputError(
        "radiosity has no solution: light is shut in among surfaces that absorb none of it; set max_depth, or "
        "reflectances below 1");
}

/// a / b, and 0 where b is not above 0.
Colord quotient(const Colord& a, const Colord& b) { return (b > 0).select(a / b.max(1e-300), Colord(Colord::Zero())); }

/// Throws InputError if a closed scene absorbs too little of a channel in which there is light.
void require_absorption(const RadiositySystem& system, const Colord& first_power) {
    if (!system.is_closed()) return;
    Colord area = Colord::Zero(), absorbed = Colord::Zero();
    for (const std::uint32_t leaf : system.leaves()) {
        area += system.area(leaf);
        absorbed += system.area(leaf) * (1 - system.reflectance(leaf));
    }
    for (int c = 0; c < 3; ++c)
        if (first_power[c] > 0 && absorbed[c] < least_absorption * area[c]) refuse_to_reflect_for_ever();
}

}  // namespace

RadiositySolution::RadiositySolution(const RadiositySystem& system, RadiositySolver solver,
                                     std::optional<int> reflections)
    : system_(system), solver_(solver), reflections_(reflections), X_(system.node_count(), Colord::Zero()) {
    for (const std::uint32_t leaf : system.leaves())
        X_[leaf] = system.first_reflection(leaf);
    term_ = X_;
    first_power_ = system.power(X_);
    if (!reflections) require_absorption(system, first_power_);
    if (reflections && *reflections < 1) X_.assign(X_.size(), Colord::Zero());
    if (!reflections || *reflections > 1) residual_ = share_of_first(X_);
}

double RadiositySolution::share_of_first(const PatchColors& values) const {
    return quotient(system_.power(values), first_power_).maxCoeff();
}

void RadiositySolution::sweep() {
    ++sweeps_;
    if (reflections_) add_reflections();
    else if (solver_ == RadiositySolver::direct) solve_directly();
    else iterate();
}

void RadiositySolution::add_reflections() {
    constexpr int least = 8;
    const int end = summed_ > *reflections_ / 2 ? *reflections_ : std::min(*reflections_, std::max(least, 2 * summed_));
    for (; summed_ < end && !has_converged(); ++summed_) {
        term_ = reflected(std::move(term_));
        for (const std::uint32_t leaf : system_.leaves())
            X_[leaf] += term_[leaf];
        residual_ = share_of_first(term_);
    }
    if (summed_ == *reflections_) residual_ = 0;
}

PatchColors RadiositySolution::reflected(PatchColors X) const {
    PatchColors E = system_.irradiance(std::move(X));
    for (const std::uint32_t leaf : system_.leaves())
        E[leaf] *= system_.reflectance(leaf);
    return E;
}

Colord RadiositySolution::product(const PatchColors& a, const PatchColors& b) const {
    Colord sum = Colord::Zero();
    for (const std::uint32_t leaf : system_.leaves())
        sum += quotient(system_.area(leaf) * a[leaf] * b[leaf], system_.reflectance(leaf));
    return sum;
}

void RadiositySolution::iterate() {
    constexpr int steps = 8;
    if (sweeps_ == 1) {
        r_ = reflected(X_);  // of X = B1
        p_ = r_;
    }
    for (int i = 0; i < steps && residual_ > 1e-12; ++i) {  // below that it is rounding
        const Colord rr = product(r_, r_);
        PatchColors Ap = p_;  // A = I - rho K
        const PatchColors rho_K_p = reflected(p_);
        for (const std::uint32_t leaf : system_.leaves())
            Ap[leaf] -= rho_K_p[leaf];
        const Colord pAp = product(p_, Ap);
        if ((rr > 0 && pAp <= 0).any()) refuse_to_reflect_for_ever();
        const Colord alpha = quotient(rr, pAp);
        for (const std::uint32_t leaf : system_.leaves()) {
            X_[leaf] += alpha * p_[leaf];
            r_[leaf] -= alpha * Ap[leaf];
        }
        const Colord beta = quotient(product(r_, r_), rr);
        for (const std::uint32_t leaf : system_.leaves())
            p_[leaf] = r_[leaf] + beta * p_[leaf];
        residual_ = share_of_first(r_);
    }
}

void RadiositySolution::solve_directly() {
    if (sweeps_ > 1) return;
    for (int c = 0; c < 3; ++c)
        if (first_power_[c] > 0) solve_channel(c);
    PatchColors r = reflected(X_);
    for (const std::uint32_t leaf : system_.leaves())
        r[leaf] += system_.first_reflection(leaf) - X_[leaf];
    residual_ = share_of_first(r);
}

void RadiositySolution::solve_channel(int c) {
    const auto& leaves = system_.leaves();
    const auto n = static_cast<Eigen::Index>(leaves.size());
    std::vector<Eigen::Index> row(system_.node_count());
    Eigen::VectorXd D(n), b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::uint32_t leaf = leaves[static_cast<std::size_t>(i)];
        row[leaf] = i;
        D[i] = std::sqrt(system_.reflectance(leaf)[c] / system_.area(leaf));
        b[i] = D[i] * system_.area(leaf) * system_.direct_irradiance(leaf)[c];
    }
    Eigen::MatrixXd M = Eigen::MatrixXd::Identity(n, n);
    for (const std::uint32_t leaf : leaves)
        for (const RadiositySystem::Link& link : system_.links_of(leaf))
            M(row[leaf], row[link.other]) -= D[row[leaf]] * D[row[link.other]] * system_.scale(leaf) *
                                             system_.scale(link.other) * static_cast<double>(link.exchange);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(M);  // in place
    if (factors.info() != Eigen::Success) refuse_to_reflect_for_ever();
    const Eigen::VectorXd Y = factors.solve(b);
    for (const std::uint32_t leaf : leaves)
        X_[leaf][c] = D[row[leaf]] * Y[row[leaf]];
}

}  // namespace gib
