#include "solve/krylov/petsc_krylov.hpp"

#include "solve/rows/vectors.hpp"

#include <array>
#include <cmath>
#include <exception>
#include <sstream>

namespace treacle::solve {

namespace {

using KspHandle = Handle<KSP, KSPDestroy>;

// Data of PETSc's callbacks. Exceptions must not pass through its C functions: they are stored here.
struct Callbacks {
    Iteration& run;
    Vec scratch, residual;
    std::exception_ptr error{};

    template <class Work>
    PetscErrorCode guard(const Work& work) {
        try {
            work();
            return 0;
        } catch (...) {
            error = std::current_exception();
            return PETSC_ERR_LIB;
        }
    }
};

// work(in, out) on the entries of two of PETSc's vectors.
template <class Work>
void on_entries(Vec in, Vec out, const Work& work) {
    PetscInt rows = 0;
    const double* from = nullptr;
    double* to = nullptr;
    check(VecGetLocalSize(in, &rows));
    check(VecGetArrayRead(in, &from));
    check(VecGetArrayWrite(out, &to));
    const auto n = static_cast<std::size_t>(rows);
    work(std::span<const double>(from, n), std::span<double>(to, n));
    check(VecRestoreArrayWrite(out, &to));
    check(VecRestoreArrayRead(in, &from));
}

PetscErrorCode multiply(Mat matrix, Vec x, Vec y) {
    void* context = nullptr;
    PetscCall(MatShellGetContext(matrix, &context));
    auto& callbacks = *static_cast<Callbacks*>(context);
    return callbacks.guard([&] { on_entries(x, y, [&](auto in, auto out) { callbacks.run.multiply(in, out); }); });
}

PetscErrorCode precondition(PC pc, Vec r, Vec z) {
    void* context = nullptr;
    PetscCall(PCShellGetContext(pc, &context));
    auto& callbacks = *static_cast<Callbacks*>(context);
    return callbacks.guard(
        [&] { on_entries(r, z, [&](auto in, auto out) { callbacks.run.preconditioner.apply(in, out); }); });
}

KSPConvergedReason judge(KSP ksp, Callbacks& callbacks) {
    auto& run = callbacks.run;
    Vec residual = nullptr;
    check(KSPBuildResidual(ksp, callbacks.scratch, callbacks.residual, &residual));
    const double* r = nullptr;
    check(VecGetArrayRead(residual, &r));
    const std::span<const double> entries(r, run.b.size());
    std::array<double, 2> sums{dot(entries, entries), run.measure(entries)};
    check(VecRestoreArrayRead(residual, &r));
    run.comm.sum(sums);
    const double norm = std::sqrt(sums[0]);
    run.report.error_measure = run.test.local ? sums[1] : norm;
    if (!std::isfinite(norm) || !std::isfinite(run.report.error_measure)) return KSP_DIVERGED_NANORINF;
    if (run.passes(norm, sums[1])) return KSP_CONVERGED_RTOL;
    double relative = 0, absolute = 0;
    check(KSPGetTolerances(ksp, &relative, &absolute, nullptr, nullptr));
    if (norm <= std::max(relative * run.norm_b, absolute)) return KSP_CONVERGED_ATOL;
    return KSP_CONVERGED_ITERATING;
}

PetscErrorCode has_converged(KSP ksp, PetscInt, PetscReal, KSPConvergedReason* reason, void* context) {
    auto& callbacks = *static_cast<Callbacks*>(context);
    return callbacks.guard([&] { *reason = judge(ksp, callbacks); });
}

void take_outcome(KSP ksp, SolveReport& report) {
    KSPConvergedReason reason{};
    check(KSPGetConvergedReason(ksp, &reason));
    PetscInt iterations = 0;
    check(KSPGetIterationNumber(ksp, &iterations));
    report.iterations = iterations;
    if (reason > 0) return void(report.outcome = Outcome::converged);
    switch (reason) {
    case KSP_DIVERGED_ITS: report.outcome = Outcome::iteration_limit; break;
    case KSP_DIVERGED_INDEFINITE_MAT: report.outcome = Outcome::indefinite_matrix; break;
    case KSP_DIVERGED_INDEFINITE_PC: report.outcome = Outcome::indefinite_preconditioner; break;
    case KSP_DIVERGED_NANORINF: report.outcome = Outcome::non_finite; break;
    default: report.outcome = Outcome::stagnated; break;
    }
    const char* words = nullptr;
    check(KSPGetConvergedReasonString(ksp, &words));
    report.reason = std::string("PETSc's Krylov method stopped without convergence: ") + words;
}

} // namespace

bool asks_for_petsc(const std::string& prefix) {
    char* all = nullptr;
    check(PetscOptionsGetAll(nullptr, &all));
    std::istringstream words(all);
    check(PetscFree(all));
    const std::string start = "-" + prefix + "_ksp_";
    for (std::string word; words >> word;) {
        // A preconditioner that is a Krylov method itself has -PREFIX_ksp_ksp_… and -PREFIX_ksp_pc_…
        if (word.starts_with(start) && !word.starts_with(start + "ksp_") && !word.starts_with(start + "pc_")) {
            return true;
        }
    }
    return false;
}

void iterate_with_petsc(Iteration& run, const std::string& prefix) {
    const auto group = treacle::native(run.comm);
    const Index rows = run.matrix.rows(), global_rows = run.matrix.global_rows();
    VecHandle x, b, scratch, residual;
    check(VecCreateMPIWithArray(group, 1, rows, global_rows, run.x.data(), x.out()));
    check(VecCreateMPIWithArray(group, 1, rows, global_rows, run.b.data(), b.out()));
    check(VecDuplicate(x, scratch.out()));
    check(VecDuplicate(x, residual.out()));
    Callbacks callbacks{run, scratch, residual};
    MatHandle matrix; // with what the caller adds to its products
    check(MatCreateShell(group, rows, rows, global_rows, global_rows, &callbacks, matrix.out()));
    check(MatShellSetOperation(matrix, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
    if (run.matrix.symmetric()) check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
    KspHandle ksp;
    check(KSPCreate(group, ksp.out()));
    check(KSPSetOptionsPrefix(ksp, (prefix + "_").c_str()));
    check(KSPSetOperators(ksp, matrix, matrix));
    check(KSPSetType(ksp, run.options.method == Method::bicgstab ? KSPBCGS : KSPCG));
    check(KSPSetInitialGuessNonzero(ksp, PETSC_TRUE));
    check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, run.options.max_iterations));
    check(KSPSetConvergenceTest(ksp, has_converged, &callbacks, nullptr));
    PC pc = nullptr;
    check(KSPGetPC(ksp, &pc));
    check(PCSetOptionsPrefix(pc, (prefix + "_built_").c_str())); // -PREFIX_pc_… have been read
    check(PCSetType(pc, run.preconditioner.is_identity() ? PCNONE : PCSHELL));
    if (!run.preconditioner.is_identity()) {
        check(PCShellSetContext(pc, &callbacks));
        check(PCShellSetApply(pc, precondition));
    }
    check(KSPSetFromOptions(ksp));
    const PetscErrorCode code = KSPSolve(ksp, b, x);
    if (callbacks.error) std::rethrow_exception(callbacks.error);
    check(code);
    take_outcome(ksp, run.report);
}

} // namespace treacle::solve
