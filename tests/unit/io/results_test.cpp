#include "base/text/error.hpp"
#include "io/export.hpp"
#include "io/manifest.hpp"
#include "io/run_folder.hpp"
#include "sample.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

using namespace treacle;
using namespace treacle::io;

namespace {
Comm world() { return Comm::world(); }

std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

void touch(const std::filesystem::path& path) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << "x";
}

template <class Work>
void on_root(Work&& work) {
    world().barrier();
    if (world().is_root()) work();
    world().barrier();
}

std::size_t files_below(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::recursive_directory_iterator(folder), {}));
}

Frame sample_frame() {
    const Sample sample(0, 4);
    Frame frame;
    frame.time = 0.5;
    frame.precision = Precision::float64;
    frame.total = 4;
    frame.positions = sample.positions;
    frame.fields = {{"velocity", "m/s", 3, sample.velocities}, {"id", "1", 1, sample.ids}};
    return frame;
}
} // namespace

TEST(RunFolder, IsMadeWithItsParts) {
    const TemporaryFolder folder(world());
    const auto run = prepare_run_folder(world(), folder.path() / "a" / "b", ExistingFiles::refuse);
    world().barrier();
    EXPECT_TRUE(std::filesystem::is_directory(run.frames()));
    EXPECT_TRUE(std::filesystem::is_directory(run.checkpoints()));
}

TEST(RunFolder, AnEmptyFolderThatExistsIsFine) {
    const TemporaryFolder folder(world());
    EXPECT_NO_THROW(prepare_run_folder(world(), folder, ExistingFiles::refuse));
}

TEST(RunFolder, OneWithFilesIsRefusedWithTheCureAndLeftAlone) {
    const TemporaryFolder folder(world());
    on_root([&] { touch(folder.path() / "steps.csv"); });
    try {
        prepare_run_folder(world(), folder, ExistingFiles::refuse);
        FAIL() << "mixed two runs";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::bad_input);
        EXPECT_NE(std::string(error.what()).find("--overwrite"), std::string::npos);
    }
    EXPECT_EQ(files_below(folder), 1u);
}

TEST(RunFolder, OverwritingRemovesTheFilesOfARunAndNoOther) {
    const TemporaryFolder folder(world());
    const std::vector<std::string> of_run = {"steps.csv", "effective.yaml", "manifest.json", "summary.json",
        "frames/liquid_000001.hdf", "frames/liquid.hdf.series", "STOP", "frames/liquid_000002.hdf.tmp",
        "checkpoints/checkpoint_000000007.h5"};
    const std::vector<std::string> of_user = {"notes.txt", "my.csv", "frames/picture.png", "scene.yaml",
        "checkpoints/old.h5", "frames/data.hdf", "liquid_000001.hdf"};
    on_root([&] {
        for (const auto& name : of_run) touch(folder.path() / name);
        for (const auto& name : of_user) touch(folder.path() / name);
    });
    prepare_run_folder(world(), folder, ExistingFiles::overwrite);
    world().barrier();
    for (const auto& name : of_run) EXPECT_FALSE(std::filesystem::exists(folder.path() / name)) << name;
    for (const auto& name : of_user) EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
}

TEST(RunFolder, APathThatIsAFileIsRefused) {
    const TemporaryFolder folder(world());
    on_root([&] { touch(folder.path() / "file"); });
    for (const auto existing : {ExistingFiles::refuse, ExistingFiles::overwrite}) {
        const auto text = error_of([&] { prepare_run_folder(world(), folder.path() / "file", existing); });
        EXPECT_NE(text.find("is a file"), std::string::npos) << text;
    }
    const auto below = error_of([&] { prepare_run_folder(world(), folder.path() / "file/a", ExistingFiles::refuse); });
    EXPECT_NE(below.find("is a file"), std::string::npos) << below;
}

TEST(RunFolder, OpeningWantsTheFolderOfARun) {
    const TemporaryFolder folder(world());
    EXPECT_NE(error_of([&] { open_run_folder(world(), folder); }).find("effective.yaml"), std::string::npos);
    EXPECT_NE(error_of([&] { open_run_folder(world(), folder.path() / "none"); }).find("no such"), std::string::npos);
    on_root([&] { touch(folder.path() / "effective.yaml"); });
    EXPECT_EQ(open_run_folder(world(), folder).steps(), folder.path() / "steps.csv");
}

TEST(RunFolder, WhileOneIsWrittenOthersAreRefusedOnEveryRankAndChangeNothing) {
    const TemporaryFolder folder(world());
    {
        const auto run = prepare_run_folder(world(), folder, ExistingFiles::refuse);
        on_root([&] { touch(run.effective_scene()); });
        for (const auto& text : {error_of([&] { prepare_run_folder(world(), folder, ExistingFiles::overwrite); }),
                 error_of([&] { open_run_folder(world(), folder, Access::write); })}) {
            EXPECT_NE(text.find("a run is writing into this folder"), std::string::npos) << text;
            EXPECT_NE(text.find("process "), std::string::npos) << text;
        }
        EXPECT_NO_THROW(open_run_folder(world(), folder)); // for reading
        world().barrier();
        EXPECT_TRUE(std::filesystem::exists(run.effective_scene()));
    }
    world().barrier();
    EXPECT_FALSE(std::filesystem::exists(folder.path() / FolderLock::file_name));
    world().barrier(); // before another is there
    EXPECT_NO_THROW(open_run_folder(world(), folder, Access::write));
}

TEST(RunFolder, ALockThatAKilledRunLeftBehindKeepsNobodyOut) {
    const TemporaryFolder folder(world());
    on_root([&] { touch(folder.path() / FolderLock::file_name); });
    EXPECT_NO_THROW(prepare_run_folder(world(), folder, ExistingFiles::refuse));
}

TEST(Manifest, TellsOfEachTimeThatTheRunWentOn) {
    const TemporaryFolder folder(world());
    const auto path = folder.path() / "manifest.json";
    Manifest manifest;
    manifest.input_text = "a: 1\n";
    write_manifest(world(), path, manifest);
    add_resumption(world(), path, {{"treacle", "resume"}, 12, "a: 1\n", {}});
    add_resumption(world(), path, {{"treacle", "resume", "--until"}, 30, "a: 2\n", {"time.end=2"}});
    world().barrier();
    const auto json = content(path);
    for (const auto& part : {"\"step\": 12", "\"step\": 30", "time.end=2", "--until"})
        EXPECT_NE(json.find(part), std::string::npos) << json;
    EXPECT_NE(json.find("\"input hash\": \"" + text_hash("a: 2\n") + "\""), std::string::npos) << json;
    EXPECT_EQ(json.find(text_hash("a: 1\n")), std::string::npos) << json;
    EXPECT_LT(json.find("\"started\""), json.find("\"resumed\"")); // of the beginning
    on_root([&] { touch(path); });
    add_resumption(world(), path, {{"treacle"}, 40, "a: 2\n", {}});
    world().barrier();
    EXPECT_NE(content(path).find("\"step\": 40"), std::string::npos);
}

TEST(Manifest, NamesWhatTheResultIsMadeWith) {
    const TemporaryFolder folder(world());
    Manifest manifest;
    manifest.command = {"treacle", "run", "a \"quoted\" scene.yaml"};
    manifest.input_text = "domain: {}\n";
    manifest.libraries = {{"PETSc", "3.18.5"}};
    manifest.extra = Value::object({{"dimensions", 3}});
    write_manifest(world(), folder.path() / "manifest.json", manifest);
    world().barrier();
    const auto text = content(folder.path() / "manifest.json");
    const std::vector<std::string> parts = {"\"ranks\": " + std::to_string(world().size()), "\"PETSc\": \"3.18.5\"",
        "\"HDF5\": \"1.", "\"MPI\": ", "\"dimensions\": 3", "\"hosts\": 1", "a \\\"quoted\\\" scene.yaml",
        text_hash("domain: {}\n"), "\"version\": \"" + build_info().version + "\""};
    for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
}

TEST(Manifest, TheHashIsThePublishedOne) {
    // Test values of FNV-1a, 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv).
    EXPECT_EQ(text_hash(""), "cbf29ce484222325");
    EXPECT_EQ(text_hash("foobar"), "85944171f73967e8");
}

TEST(Value, KeepsOrderAndTypesAndNamesWhatIsNotFinite) {
    Value value;
    value.set("z", 1).set("a", 0.1).set("z", 2);
    value.set("list", Value().add(true).add(std::numeric_limits<double>::quiet_NaN()));
    EXPECT_EQ(value.json(), "{\n  \"z\": 2,\n  \"a\": 0.1,\n  \"list\": [\n    true,\n    \"nan\"\n  ]\n}");
    EXPECT_THROW(value.add(1), std::logic_error);
    EXPECT_THROW(Value(1).set("a", 1), std::logic_error);
}

TEST(Export, CsvHasUnitsAndDigitsThatComeBack) {
    const TemporaryFolder folder(world());
    on_root([&] { export_particles(folder.path() / "a.csv", sample_frame(), ExportFormat::csv); });
    std::istringstream text(content(folder.path() / "a.csv"));
    std::string header, row;
    std::getline(text, header);
    std::getline(text, row);
    std::getline(text, row);
    EXPECT_EQ(header, "x [m],y [m],z [m],velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],id [1]");
    EXPECT_EQ(row, "0.25,-0.5,0.3333333333333333,0.1,0,-1,1099511627777");
}

TEST(Export, ObjAndUnknownFormatsAreRefused) {
    EXPECT_EQ(export_format("vtp"), ExportFormat::vtp);
    EXPECT_NE(error_of([] { export_format("obj"); }).find("velocity"), std::string::npos);
    EXPECT_NE(error_of([] { export_format("stl"); }).find("ply, vtp and csv"), std::string::npos);
}

TEST(Export, IntegersThatPlyCannotHoldAreRefusedAndNoFileIsLeft) {
    const TemporaryFolder folder(world());
    auto frame = sample_frame();
    std::get<std::vector<std::int64_t>>(frame.fields[1].values)[2] = (std::int64_t{1} << 53) + 1;
    on_root([&] { EXPECT_THROW(export_particles(folder.path() / "a.ply", frame, ExportFormat::ply), InputError); });
    EXPECT_EQ(files_below(folder), 0u);
}

TEST(Export, AFolderThatIsMissingIsAnError) {
    const TemporaryFolder folder(world());
    EXPECT_THROW(export_particles(folder.path() / "none/a.csv", sample_frame(), ExportFormat::csv), SimulationError);
}
