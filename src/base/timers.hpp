#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace treacle {

// Wall-clock seconds and calls per named phase. The first use of a name allocates, later ones do not.
// A phase measured inside another counts in both.
class PhaseTimers {
public:
    struct Phase {
        std::string name;       // "pressure", in the table of times
        double seconds = 0;     // wall clock, of all calls [s]
        std::int64_t calls = 0; // that have ended
    };

    // Adds the time from its making to its end to a phase.
    class Scope {
    public:
        Scope(PhaseTimers& timers, std::size_t phase);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        PhaseTimers& timers_;
        std::size_t phase_;
        std::chrono::steady_clock::time_point start_;
    };

    // Measures one call: until the end of what it returns.
    [[nodiscard]] Scope scope(std::string_view name) {
        if (wait_) wait_();
        return Scope(*this, index(name));
    }

    // Called before the clock of each phase starts: with a barrier, a phase no longer counts the time in which its rank
    // blocks until slower ones end the phase before.
    void wait_before(std::function<void()> wait) { wait_ = std::move(wait); }

    // In the order of first use.
    const std::vector<Phase>& phases() const { return phases_; }

    // Zero for a phase that has not run.
    double seconds(std::string_view name) const;
    std::int64_t calls(std::string_view name) const;

    // Sets all to zero and keeps the names.
    void reset();

private:
    std::size_t index(std::string_view name);
    const Phase* find(std::string_view name) const;

    std::vector<Phase> phases_;
    std::function<void()> wait_;
};

} // namespace treacle
