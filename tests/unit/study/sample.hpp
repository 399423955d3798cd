#pragma once
#include "base/options/document.hpp"
#include "base/options/options.hpp"
#include "study/model/study.hpp"

#include <string>

namespace treacle::study {

// A study from the text of its file.
inline Study study_of(const std::string& text) {
    Study study;
    study.path = "/studies/study.yaml";
    parse(Document::from_text(text, "study.yaml"), study);
    return study;
}

inline const std::string header = "schema_version: 1\nscenes:\n  - file: scene.yaml\n";

// The text of the error of some work; empty when there is none.
template <class Work>
std::string complaint_of(Work&& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

} // namespace treacle::study
