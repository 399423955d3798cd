#pragma once
#include <coroutine>
#include <exception>
#include <optional>
#include <utility>

namespace treacle::search {

// Part of a method that may wait for values: a coroutine that begins when it is awaited, or started, and goes on with
// its caller when it ends.
template <class T>
class [[nodiscard]] Task;

namespace detail {
struct TaskPromiseBase {
    std::coroutine_handle<> caller;
    std::exception_ptr error;

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
    void rethrow() const {
        if (error) std::rethrow_exception(error);
    }
};

template <class T>
struct TaskPromise : TaskPromiseBase {
    std::optional<T> result;
    Task<T> get_return_object();
    void return_value(T value) { result = std::move(value); }
    T take() {
        rethrow();
        return std::move(*result);
    }
};

template <>
struct TaskPromise<void> : TaskPromiseBase {
    Task<void> get_return_object();
    void return_void() {}
    void take() const { rethrow(); }
};
} // namespace detail

template <class T>
class [[nodiscard]] Task {
public:
    using promise_type = detail::TaskPromise<T>;
    using Handle = std::coroutine_handle<promise_type>;

    explicit Task(Handle handle) : handle_(handle) {}
    Task(Task&& other) noexcept : handle_(std::exchange(other.handle_, {})) {}
    Task& operator=(Task&&) = delete;
    ~Task() {
        if (handle_) handle_.destroy();
    }

    bool await_ready() const noexcept { return false; }
    std::coroutine_handle<> await_suspend(std::coroutine_handle<> caller) noexcept {
        handle_.promise().caller = caller;
        return handle_;
    }
    T await_resume() { return handle_.promise().take(); }

    // A task that nothing awaits.
    void start() { handle_.resume(); }
    bool done() const { return handle_.done(); }
    // Throws what the task has thrown.
    void check() const { handle_.promise().rethrow(); }

private:
    Handle handle_;
};

namespace detail {
template <class T>
Task<T> TaskPromise<T>::get_return_object() {
    return Task<T>(std::coroutine_handle<TaskPromise<T>>::from_promise(*this));
}
inline Task<void> TaskPromise<void>::get_return_object() {
    return Task<void>(std::coroutine_handle<TaskPromise<void>>::from_promise(*this));
}
} // namespace detail

} // namespace treacle::search
