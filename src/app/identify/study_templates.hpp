#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace treacle::app {

// A file of inputs/templates, "dam_break/scene.yaml", as it was when the program was built.
struct TemplateFile {
    std::string_view name, text;
};
std::span<const TemplateFile> template_files();
// Empty when there is no such file.
std::string_view template_text(const std::string& name);

// Values of a template's form and of the options of `treacle new`, by their names, in SI.
using FormValues = std::map<std::string, double>;

// A textbook formula that gives the first guess of a template's viscosity.
struct FirstGuess {
    std::vector<std::string> takes;         // options of `treacle new`, all of them
    std::string source;                     // "Huppert 1982, spreading from a wall"
    double (*viscosity)(const FormValues&); // [Pa s] of the form's values and the options'
};

// An experiment of `treacle new`: its files are those of the folder of its name.
struct StudyTemplate {
    std::string name;
    std::vector<FirstGuess> guesses;
};
const std::vector<StudyTemplate>& study_templates();

} // namespace treacle::app
