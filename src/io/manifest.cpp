#include "io/manifest.hpp"

#include "base/text/file.hpp"
#include "build_info.hpp"
#include "mpi/native.hpp"

#include <hdf5.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <set>
#include <unistd.h>

namespace treacle::io {

namespace {
std::uint64_t fnv1a(const std::string& text) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const unsigned char c : text) hash = (hash ^ c) * 0x100000001b3ULL;
    return hash;
}

std::string time_now() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

std::string dotted(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string mpi_version() {
#if defined(OPEN_MPI)
    return "Open MPI " + dotted(OMPI_MAJOR_VERSION, OMPI_MINOR_VERSION, OMPI_RELEASE_VERSION);
#elif defined(MPICH_VERSION)
    return "MPICH " MPICH_VERSION;
#else
    return "unknown";
#endif
}

Value sources(const BuildInfo& build) { return Value::object({{"commit", build.commit}, {"state", build.state}}); }
} // namespace

BuildInfo build_info() {
    return {build::version, build::commit, build::state, build::compiler, build::flags, build::type};
}

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

Versions library_versions() {
    unsigned major = 0, minor = 0, patch = 0;
    H5get_libversion(&major, &minor, &patch);
    return {{"HDF5", dotted(static_cast<int>(major), static_cast<int>(minor), static_cast<int>(patch))},
        {"MPI", mpi_version()}};
}

std::string text_hash(const std::string& text) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(text)));
    return digits;
}

void write_manifest(const Comm& comm, const std::filesystem::path& path, const Manifest& manifest) {
    // Hosts are counted by the hash of their name: names need not travel for that.
    const auto hashes = comm.all_gather(static_cast<std::int64_t>(fnv1a(host_name())));
    const auto hosts = std::set<std::int64_t>(hashes.begin(), hashes.end()).size();
    comm.guard_root([&] {
        const auto build = build_info();
        Value libraries = Value::object({});
        for (const auto& [name, version] : library_versions()) libraries.set(name, version);
        for (const auto& [name, version] : manifest.libraries) libraries.set(name, version);
        Value command = Value::list({});
        for (const auto& word : manifest.command) command.add(word);
        Value out = Value::object({{"program", "treacle"}, {"version", build.version}, {"sources", sources(build)}});
        out.set("compiler", Value::object({{"name", build.compiler}, {"flags", build.flags}, {"type", build.type}}));
        out.set("libraries", libraries);
        out.set("ranks", comm.size());
        out.set("hosts", static_cast<std::int64_t>(hosts)).set("first host", host_name());
        out.set("started", time_now()).set("command", command);
        out.set("input", manifest.input).set("input hash", text_hash(manifest.input_text));
        if (const auto* entries = std::get_if<Value::Object>(&manifest.extra.data()))
            for (const auto& [key, value] : *entries) out.set(key, value);
        write_json(path, out);
    });
}

void add_resumption(const Comm& comm, const std::filesystem::path& path, const Resumption& resumption) {
    comm.guard_root([&] {
        std::ifstream file(path);
        auto manifest = nlohmann::ordered_json::parse(file, nullptr, false);
        if (!manifest.is_object()) manifest = {{"program", "treacle"}};
        manifest["input hash"] = text_hash(resumption.input_text);
        auto& all = manifest["resumed"];
        if (!all.is_array()) all = nlohmann::ordered_json::array();
        all.push_back({{"started", time_now()}, {"step", resumption.step}, {"ranks", comm.size()},
            {"version", build_info().version}, {"command", resumption.command}, {"changes", resumption.changes}});
        write_file_atomically(path, manifest.dump(2) + "\n");
    });
}

void write_summary(const Comm& comm, const std::filesystem::path& path, const Value& summary) {
    comm.guard_root([&] { write_json(path, summary); });
}

} // namespace treacle::io
