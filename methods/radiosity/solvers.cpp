#include "common/core/error.h"
#include "methods/radiosity/system.h"

#include <Eigen/Cholesky>

namespace gib {

namespace {

[[noreturn]] void refuse_to_reflect_for_ever() {
    throw InputError(
        "radiosity has no solution: light is shut in among surfaces that absorb none of it; set max_depth, or "
        "reflectances below 1");
}

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

/// Conjugate gradients on (A / rho - G) X = A E_direct, three channels at once, with the diagonal A / rho as a
/// preconditioner. Source: Saad 2003, "Iterative Methods for Sparse Linear Systems", algorithm 9.1. X is 0 in the
/// channels in which a patch reflects nothing.
class ConjugateGradient final : public RadiositySolution {
public:
    explicit ConjugateGradient(const RadiositySystem& system) : RadiositySolution(system) {
        // With X = B1 the residual of the scaled system is A K B1.
        z_ = system_.irradiance(X_);
        for (const std::uint32_t leaf : system_.leaves())
            z_[leaf] *= system_.reflectance(leaf);
        direction_ = z_;
        product_ = dot(z_, z_);
        residual_ = residual_power(z_).maxCoeff();
    }

    void sweep() override {
        ++sweeps_;
        PatchColors image = system_.irradiance(direction_);  // K d
        Colord curvature = Colord::Zero();
        for (const std::uint32_t leaf : system_.leaves()) {
            image[leaf] = direction_[leaf] - system_.reflectance(leaf) * image[leaf];
            curvature += weight(leaf) * direction_[leaf] * image[leaf];
        }
        require_curvature(curvature);
        const Colord step = ratio(product_, curvature);
        for (const std::uint32_t leaf : system_.leaves()) {
            X_[leaf] += step * direction_[leaf];
            z_[leaf] -= step * image[leaf];
        }
        const Colord next = dot(z_, z_), turn = ratio(next, product_);
        for (const std::uint32_t leaf : system_.leaves())
            direction_[leaf] = z_[leaf] + turn * direction_[leaf];
        product_ = next;
        residual_ = residual_power(z_).maxCoeff();
        system_.pull(X_);
    }

private:
    /// A / rho; 0 where nothing is reflected.
    Colord weight(std::uint32_t leaf) const {
        const Colord& rho = system_.reflectance(leaf);
        return (rho > 0).select(system_.area(leaf) / rho.max(1e-300), Colord(Colord::Zero()));
    }
    /// The sum of A / rho a b. As z is rho / A times the residual, dot(z, z) is the product of z and the residual.
    Colord dot(const PatchColors& a, const PatchColors& b) const {
        Colord sum = Colord::Zero();
        for (const std::uint32_t leaf : system_.leaves())
            sum += weight(leaf) * a[leaf] * b[leaf];
        return sum;
    }
    /// In every direction d the curvature d (A / rho - G) d is at least the absorbed share times d (A / rho) d.
    /// Throws InputError if it shows that less than least_absorption is absorbed.
    void require_curvature(const Colord& curvature) const {
        const Colord length = dot(direction_, direction_);
        for (int c = 0; c < 3; ++c)
            if (curvature[c] < least_absorption * length[c]) refuse_to_reflect_for_ever();
    }
    static Colord ratio(const Colord& a, const Colord& b) {
        return (b > 0).select(a / b.max(1e-300), Colord(Colord::Zero()));
    }

    PatchColors z_, direction_;
    Colord product_;
};

/// Gauss-Seidel iteration: each patch in turn takes the light that the others send it at that moment.
class GaussSeidel final : public RadiositySolution {
public:
    explicit GaussSeidel(const RadiositySystem& system) : RadiositySolution(system) {}

    void sweep() override {
        ++sweeps_;
        for (const std::uint32_t i : system_.leaves()) {
            Colord sum = Colord::Zero();
            for (const LinkTable::Entry& link : system_.links().of(i))
                sum += static_cast<double>(link.exchange) * system_.scale(link.other) * X_[link.other];
            X_[i] = first_[i] + system_.reflectance(i) * (system_.scale(i) / system_.area(i)) * sum;
        }
        system_.pull(X_);
        measure_residual();
    }
};

/// Progressive refinement: the patch with the most power that is not yet shot shoots it (Southwell's choice); a sweep
/// does this as many times as there are patches. Source: Cohen, Chen, Wallace and Greenberg 1988, "A Progressive
/// Refinement Approach to Fast Radiosity Image Generation". For display their ambient estimate is added.
class Shooting final : public RadiositySolution {
public:
    explicit Shooting(const RadiositySystem& system) : RadiositySolution(system), unshot_(first_) {}

    void sweep() override {
        ++sweeps_;
        for (std::size_t shot = 0; shot < system_.size(); ++shot) {
            const std::uint32_t from = most_powerful();
            const Colord sent = system_.scale(from) * unshot_[from];
            if (!(sent.maxCoeff() > 0)) break;
            unshot_[from] = Colord::Zero();
            for (const LinkTable::Entry& link : system_.links().of(from)) {
                const std::uint32_t to = link.other;
                const Colord added = system_.reflectance(to) * sent *
                                     (static_cast<double>(link.exchange) * system_.scale(to) / system_.area(to));
                X_[to] += added;
                unshot_[to] += added;
            }
        }
        residual_ = residual_power(unshot_).maxCoeff();
        system_.pull(X_);
    }

    PatchColors shown() const override {
        Colord left = Colord::Zero(), absorbing = Colord::Zero();
        for (const std::uint32_t leaf : system_.leaves()) {
            left += system_.area(leaf) * unshot_[leaf];
            absorbing += system_.area(leaf) * (1 - system_.reflectance(leaf));
        }
        const Colord ambient = (absorbing > 0).select(left / absorbing.max(1e-300), Colord(Colord::Zero()));
        PatchColors X = X_;
        for (const std::uint32_t leaf : system_.leaves())
            X[leaf] += system_.reflectance(leaf) * ambient;
        system_.pull(X);
        return X;
    }

private:
    std::uint32_t most_powerful() const {
        std::uint32_t best = system_.leaves().front();
        double most = -1;
        for (const std::uint32_t leaf : system_.leaves()) {
            const double power = system_.area(leaf) * unshot_[leaf].sum();
            if (power > most) {
                most = power;
                best = leaf;
            }
        }
        return best;
    }

    PatchColors unshot_;
};

/// The Neumann series B1 + rho K B1 + ..., cut off after a number of reflections.
class Series final : public RadiositySolution {
public:
    Series(const RadiositySystem& system, int reflections)
        : RadiositySolution(system), reflections_(reflections), term_(first_) {
        if (reflections_ < 1)
            for (Colord& x : X_)
                x.setZero();
        if (reflections_ < 2) residual_ = 0;
    }

    void sweep() override {
        ++sweeps_;
        const int end = summed_ > reflections_ / 2 ? reflections_ : 2 * summed_;
        for (; summed_ < end; ++summed_) {
            term_ = system_.irradiance(std::move(term_));
            for (const std::uint32_t leaf : system_.leaves()) {
                term_[leaf] *= system_.reflectance(leaf);
                X_[leaf] += term_[leaf];
            }
        }
        residual_ = summed_ < reflections_ ? residual_power(term_).maxCoeff() : 0;
        system_.pull(X_);
    }

private:
    int reflections_, summed_ = 1;
    PatchColors term_;
};

/// Solves with Cholesky's factors of the whole matrix A / rho - G, one channel after another.
class Direct final : public RadiositySolution {
public:
    explicit Direct(const RadiositySystem& system) : RadiositySolution(system) {}

    void sweep() override {
        ++sweeps_;
        if (sweeps_ > 1) return;
        for (int c = 0; c < 3; ++c)
            solve(c);
        system_.pull(X_);
        measure_residual();
    }

private:
    void solve(int c) {
        if (!(first_power_[c] > 0)) return;  // where nothing is absorbed either there are no factors
        std::vector<std::uint32_t> leaves;
        std::vector<Eigen::Index> row(X_.size(), -1);
        for (const std::uint32_t leaf : system_.leaves()) {
            if (!(system_.reflectance(leaf)[c] > 0)) continue;
            row[leaf] = static_cast<Eigen::Index>(leaves.size());
            leaves.push_back(leaf);
        }
        const auto n = static_cast<Eigen::Index>(leaves.size());
        Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd b(n);
        for (const std::uint32_t i : leaves) {
            const double rho = system_.reflectance(i)[c];
            M(row[i], row[i]) += system_.area(i) / rho;
            b[row[i]] = system_.area(i) * first_[i][c] / rho;
            for (const LinkTable::Entry& link : system_.links().of(i))
                if (row[link.other] >= 0)
                    M(row[i], row[link.other]) -=
                        static_cast<double>(link.exchange) * system_.scale(i) * system_.scale(link.other);
        }
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(M);  // in place
        if (factors.info() != Eigen::Success) refuse_to_reflect_for_ever();
        const Eigen::VectorXd X = factors.solve(b);
        for (const std::uint32_t i : leaves)
            X_[i][c] = X[row[i]];
    }
};

}  // namespace

std::unique_ptr<RadiositySolution> start_solution(const RadiositySystem& system, RadiositySolver solver) {
    PatchColors first(system.node_count(), Colord::Zero());
    for (const std::uint32_t leaf : system.leaves())
        first[leaf] = system.first_reflection(leaf);
    require_absorption(system, system.power(first));
    switch (solver) {
        case RadiositySolver::gauss_seidel:
            return std::make_unique<GaussSeidel>(system);
        case RadiositySolver::shooting:
            return std::make_unique<Shooting>(system);
        case RadiositySolver::direct:
            return std::make_unique<Direct>(system);
        case RadiositySolver::hierarchical:
        case RadiositySolver::conjugate_gradient:
            break;
    }
    return std::make_unique<ConjugateGradient>(system);
}

std::unique_ptr<RadiositySolution> start_series(const RadiositySystem& system, int reflections) {
    return std::make_unique<Series>(system, reflections);
}

}  // namespace gib
