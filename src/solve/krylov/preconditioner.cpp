#include "solve/krylov/preconditioner.hpp"

#include "base/text/error.hpp"
#include "solve/rows/vectors.hpp"

#include <stdexcept>

namespace treacle::solve {

namespace {

PCType pc_type(Preconditioner preconditioner) {
    switch (preconditioner) {
    case Preconditioner::none: return PCNONE;
    case Preconditioner::jacobi: return PCJACOBI;
    case Preconditioner::ic0: return PCBJACOBI;
    case Preconditioner::ssor: return PCSOR;
    case Preconditioner::sor_jacobi: return PCKSP;
    case Preconditioner::gamg: return PCGAMG;
    case Preconditioner::boomeramg: return PCHYPRE;
    }
    throw std::logic_error("unknown preconditioner");
}

// BoomerAMG has no functions for its settings, only options: ours go through a database of their own, read
// before the program's, so that they are defaults.
void set_boomeramg_defaults(PC pc, const std::string& prefix, const KrylovOptions& options) {
    OptionsHandle defaults;
    check(PetscOptionsCreate(defaults.out()));
    const std::string key = "-" + prefix + "_pc_hypre_boomeramg_";
    auto set = [&](const char* name, const std::string& value) {
        check(PetscOptionsSetValue(defaults, (key + name).c_str(), value.c_str()));
    };
    set("strong_threshold", std::to_string(options.strong_threshold));
    set("coarsen_type", "HMIS");
    set("interp_type", "ext+i");
    set("P_max", "4");
    set("agg_nl", "1");
    set("relax_type_all", "l1scaled-SOR/Jacobi");
    // A direct solve of a singular coarse matrix would return an arbitrarily large constant.
    const bool singular = options.null_space == NullSpace::constant;
    set("relax_type_coarse", singular ? "l1scaled-SOR/Jacobi" : "Gaussian-elimination");
    check(PCHYPRESetType(pc, "boomeramg"));
    const auto object = reinterpret_cast<PetscObject>(pc);
    check(PetscObjectSetOptions(object, defaults));
    const PetscErrorCode code = PCSetFromOptions(pc);
    check(PetscObjectSetOptions(object, nullptr));
    check(code);
}

// The block of each rank exists only after the first set-up.
void set_ic0_blocks(PC pc) {
    check(PCSetUp(pc));
    PetscInt blocks = 0;
    KSP* solvers = nullptr;
    check(PCBJacobiGetSubKSP(pc, &blocks, nullptr, &solvers));
    for (PetscInt i = 0; i < blocks; ++i) {
        PC block = nullptr;
        check(KSPGetPC(solvers[i], &block));
        check(PCSetType(block, PCICC));
        check(PCFactorSetShiftType(block, MAT_SHIFT_POSITIVE_DEFINITE));
        check(KSPSetFromOptions(solvers[i]));
    }
}

// Two Richardson steps with Jacobi's preconditioner from zero.
void set_sor_jacobi(PC pc, double relaxation) {
    constexpr int sweeps = 2;
    KSP sweep = nullptr;
    PC diagonal = nullptr;
    check(PCKSPGetKSP(pc, &sweep));
    check(KSPSetType(sweep, KSPRICHARDSON));
    check(KSPRichardsonSetScale(sweep, relaxation));
    check(KSPSetNormType(sweep, KSP_NORM_NONE));
    check(KSPSetConvergenceTest(sweep, KSPConvergedSkip, nullptr, nullptr));
    check(KSPSetTolerances(sweep, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, sweeps));
    check(KSPGetPC(sweep, &diagonal));
    check(PCSetType(diagonal, PCJACOBI));
}

bool is_type(PC pc, PCType type) {
    PetscBool same = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), type, &same));
    return same == PETSC_TRUE;
}

} // namespace

void BuiltPreconditioner::build(Matrix& matrix, const std::string& prefix, const KrylovOptions& options) {
    check(PCCreate(treacle::native(matrix.comm()), pc_.out()));
    check(PCSetOptionsPrefix(pc_, (prefix + "_").c_str()));
    check(PCSetOperators(pc_, native_->mat, native_->mat));
    check(PCSetType(pc_, pc_type(options.preconditioner)));
    if (options.preconditioner == Preconditioner::ssor) {
        check(PCSORSetSymmetric(pc_, SOR_LOCAL_SYMMETRIC_SWEEP));
        check(PCSORSetOmega(pc_, options.relaxation));
        check(PCSORSetIterations(pc_, options.sweeps, 1));
    }
    if (options.preconditioner == Preconditioner::sor_jacobi) set_sor_jacobi(pc_, options.relaxation);
    if (options.preconditioner == Preconditioner::boomeramg) set_boomeramg_defaults(pc_, prefix, options);
    check(PCSetFromOptions(pc_));
    if (options.preconditioner == Preconditioner::ic0 && is_type(pc_, PCBJACOBI)) set_ic0_blocks(pc_);
    if (is_type(pc_, PCEISENSTAT)) {
        pc_.reset();
        throw InputError({"-" + prefix + "_pc_type", "eisenstat does not work here",
            "it changes the system behind PETSc's own Krylov methods, and ours is another",
            "sor is the same preconditioner"});
    }
    identity_ = is_type(pc_, PCNONE);
    cheap_ = identity_ || is_type(pc_, PCJACOBI) || is_type(pc_, PCBJACOBI) || is_type(pc_, PCSOR);
}

void BuiltPreconditioner::set_up_user(Matrix& matrix) {
    if (user_revision_ == matrix.revision()) return;
    if (user_.set_up) user_.set_up(matrix);
    user_revision_ = matrix.revision();
}

bool BuiltPreconditioner::set_up(Matrix& matrix, const std::string& prefix, const KrylovOptions& options) {
    comm_ = matrix.comm();
    null_space_ = options.null_space;
    global_rows_ = matrix.global_rows();
    user_ = options.user;
    if (global_rows_ == 0) { // nothing to prepare, and PETSc and a caller's hierarchy make nothing of it
        release();
        user_ = {};
        ready_ = cheap_ = identity_ = true;
        return true;
    }
    ready_ = true;
    if (user_) {
        cheap_ = identity_ = false;
        set_up_user(matrix);
        return true;
    }
    native_ = &matrix.native();
    Mat current = nullptr;
    if (pc_) check(PCGetOperators(pc_, &current, nullptr));
    if (current != native_->mat) {
        const bool definite = matrix.symmetric() && null_space_ != NullSpace::constant;
        check(MatSetOption(native_->mat, MAT_SPD, definite ? PETSC_TRUE : PETSC_FALSE));
        build(matrix, prefix, options);
    }
    check(PCSetUp(pc_));
    check(PCSetUpOnBlocks(pc_));
    PCFailedReason failure = PC_NOERROR;
    check(PCGetFailedReason(pc_, &failure));
    const bool failed = comm_.any(failure != PC_NOERROR);
    if (failed) release();
    return !failed;
}

void BuiltPreconditioner::project(std::span<double> z) const {
    const double mean = comm_.sum(total(z)) / global_rows_;
    for (double& value : z) value -= mean;
}

void BuiltPreconditioner::apply(std::span<const double> r, std::span<double> z) {
    if (!ready_) throw std::logic_error("preconditioner applied before it was set up");
    if (global_rows_ == 0) return;
    if (user_) {
        user_.apply(r, z);
    } else {
        native_->on(r, z, [this](Vec in, Vec out) { return PCApply(pc_, in, out); });
    }
    if (null_space_ == NullSpace::constant) project(z);
}

void BuiltPreconditioner::release() {
    pc_.reset();
    native_ = nullptr;
    user_revision_ = 0;
    ready_ = false;
}

} // namespace treacle::solve
