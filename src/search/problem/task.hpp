#pragma once
#include <coroutine>
#include <exception>
#include <optional>
#include <utility>

namespace treacle::search {

// Part of a method that may suspend until values arrive: a coroutine that begins when it is awaited, or started, and
// resumes its caller when it ends.
template <class T>
class [[nodiscard]] Task;

namespace detail {
// Promise of a Task without its result.
struct TaskPromiseBase {
    std::coroutine_handle<> caller; // resumed when the task ends; null: no caller
    std::exception_ptr error;       // exception that left the task's body; null: none

    // Members that the compiler calls ([dcl.fct.def.coroutine]): a task is suspended at first, and at its end resumes
    // its caller without growing the stack (symmetric transfer).
    std::suspend_always initial_suspend() noexcept { return {}; }
    struct Final {
        bool await_ready() noexcept { return false; }
        template <class Promise>
        std::coroutine_handle<> await_suspend(std::coroutine_handle<Promise> done) noexcept {
            const auto caller = done.promise().caller;
            return caller ? caller : std::noop_coroutine();
        }
        void await_resume() noexcept {}
    };
    Final final_suspend() noexcept { return {}; }
    void unhandled_exception() { error = std::current_exception(); }
    // Throws the exception that left the body, if any.
    void rethrow() const {
        if (error) std::rethrow_exception(error);
    }
};

// Promise of a Task with a result.
template <class T>
struct TaskPromise : TaskPromiseBase {
    std::optional<T> result; // empty until the body has returned
    // Members that the compiler calls: the task for this promise, and `co_return value`.
    Task<T> get_return_object();
    void return_value(T value) { result = std::move(value); }
    // Moves the result out, once; throws the exception that left the body.
    T take() {
        rethrow();
        return std::move(*result);
    }
};

// Promise of a Task without a result.
template <>
struct TaskPromise<void> : TaskPromiseBase {
    Task<void> get_return_object();
    void return_void() {}
    void take() const { rethrow(); }
};
} // namespace detail

// Owns its coroutine, which ends with it; movable, not copyable.
template <class T>
class [[nodiscard]] Task {
public:
    using promise_type = detail::TaskPromise<T>;
    using Handle = std::coroutine_handle<promise_type>;

    // Takes over the coroutine; a task that was moved from is empty.
    explicit Task(Handle handle) : handle_(handle) {}
    Task(Task&& other) noexcept : handle_(std::exchange(other.handle_, {})) {}
    Task& operator=(Task&&) = delete;
    ~Task() {
        if (handle_) handle_.destroy();
    }

    // Members that the compiler calls at `co_await task`: the task begins, its caller resumes at its end with the
    // result of type T, or with the exception.
    bool await_ready() const noexcept { return false; }
    std::coroutine_handle<> await_suspend(std::coroutine_handle<> caller) noexcept {
        handle_.promise().caller = caller;
        return handle_;
    }
    T await_resume() { return handle_.promise().take(); }

    // Begins a task that no coroutine awaits.
    void start() { handle_.resume(); }
    bool done() const { return handle_.done(); }
    // Throws what the task has thrown.
    void check() const { handle_.promise().rethrow(); }

private:
    Handle handle_;
};

namespace detail {
// Needs the complete Task.
template <class T>
Task<T> TaskPromise<T>::get_return_object() {
    return Task<T>(std::coroutine_handle<TaskPromise<T>>::from_promise(*this));
}
inline Task<void> TaskPromise<void>::get_return_object() {
    return Task<void>(std::coroutine_handle<TaskPromise<void>>::from_promise(*this));
}
} // namespace detail

} // namespace treacle::search
