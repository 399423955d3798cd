#include "app/command_line.hpp"

#include "app/export/manual.hpp"
#include "app/study_commands.hpp"
#include "app/subcommands.hpp"
#include "app/video_commands.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <array>

namespace treacle::app {

namespace {

void add_commands(CLI::App& program, Chosen& chosen, const Words& arguments) {
    add_run(program, chosen, arguments);
    add_resume(program, chosen, arguments);
    add_check(program, chosen);
    add_manuals(program, chosen);
    add_info(program, chosen);
    add_export(program, chosen);
    add_render(program, chosen);
    add_study_commands(program, {[&chosen](std::function<Command()> make) { chosen.make = std::move(make); },
                                    [&chosen](std::function<ExitCode()> alone) { chosen.alone = std::move(alone); }});
    add_video_commands(program, [&chosen](std::function<Command()> make) { chosen.make = std::move(make); });
    add_calibrate(program, chosen);
    add_bench(program, chosen);
}

constexpr const char* exit_codes = R"(
Exit codes: 0 ok, 2 bad input, 3 the simulation failed, 4 out of memory, 5 stopped with a checkpoint.
`treacle COMMAND --help` shows the options of a command, `treacle schema` the keys of a scene.)";

// A value that starts with '-' would be taken for an option unless it is joined to its own.
Words join_values(const Words& arguments) {
    Words out;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const auto& word = arguments[i];
        const bool takes = word == "--petsc" || word == "--frames" || word == "--range";
        if (takes && i + 1 < arguments.size()) {
            out.push_back(word + "=" + arguments[++i]);
        } else {
            out.push_back(word);
        }
    }
    return out;
}

Words command_names(const CLI::App& program) {
    Words names;
    for (const auto* app : program.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(app->get_name());
    return names;
}

Words option_names(const CLI::App& app) {
    Words names;
    for (const auto* option : app.get_options()) {
        for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::string suggestion(const std::string& word, const Words& known) {
    const auto close = nearest(word, known);
    return close ? "did you mean " + *close + "?" : "";
}

InputError unknown_command(const std::string& word, const Words& known) {
    const auto close = suggestion(word, known);
    return InputError({"treacle", word + " is no command" + (close.empty() ? "" : "; " + close),
        "there are " + join(known, ", "), "`treacle --help` describes them"});
}

InputError explain(const CLI::App& app, const CLI::ParseError& error) {
    const std::string where = "treacle " + app.get_name();
    const std::string cure = "`" + where + " --help` shows what it takes";
    const auto extras = app.remaining(true);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || extras.empty()) {
        return InputError({where, error.what(), "", cure});
    }
    const auto word = extras.front().substr(0, extras.front().find('='));
    if (word.front() != '-') return InputError({where, "too many arguments: " + word, "", cure});
    const auto close = suggestion(word, option_names(app));
    return InputError({where, word + " is no option of it" + (close.empty() ? "" : "; " + close), "", cure});
}

} // namespace

CommandLine read_command_line(const Words& arguments) {
    Chosen chosen;
    CLI::App program("Viscous liquids with free surfaces and solid bodies.", "treacle");
    program.footer(exit_codes);
    program.require_subcommand(0, 1);
    program.set_help_flag("-h,--help", "This text");
    bool version = false;
    program.add_flag("--version", version, "Version of the program, its sources, compiler and libraries");
    add_commands(program, chosen, arguments);
    if (arguments.size() < 2) return {"", print(program.help()), {}};
    auto words = join_values({arguments.begin() + 1, arguments.end()});
    const auto known = command_names(program);
    if (words.front().front() != '-' && std::ranges::find(known, words.front()) == known.end()) {
        throw unknown_command(words.front(), known);
    }
    std::ranges::reverse(words);
    const auto used = [&]() -> const CLI::App& {
        const auto parsed = program.get_subcommands();
        return parsed.empty() ? program : *parsed.front();
    };
    try {
        program.parse(std::move(words));
    } catch (const CLI::CallForHelp&) {
        return {"", print(used().help(&used() == &program ? "" : std::string("treacle"))), {}};
    } catch (const CLI::ParseError& error) {
        throw explain(used(), error);
    }
    if (version) return {"", [](const Comm& comm) { return print(version_text())(comm); }, {}};
    if (!chosen.make) return {"", print(program.help()), {}};
    return {chosen.petsc, chosen.make(), chosen.alone};
}

bool may_go_alone(const Words& arguments) {
    constexpr std::array names{"new", "sweep", "identify", "next", "study"};
    return arguments.size() > 1 && std::ranges::find(names, arguments[1]) != names.end();
}

} // namespace treacle::app
