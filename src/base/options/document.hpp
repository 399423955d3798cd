#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace treacle {

struct DocumentTree; // private to base

// A key of earlier versions and its present name; or, with a `word`, a word that was a value of the key.
struct Renamed {
    std::string path; // of the key; blocks around it by their present names, `*` for each item of a list
    std::string now;  // the key's present name, or the present word
    std::string word = {};
};

// An override's path "a.b.c" by present names.
std::string present_path(const std::string& path, std::span<const Renamed> table);

// A YAML file, read but not interpreted: blocks, lists and words, each with its place.
class Document {
public:
    // Throw InputError when the file cannot be read or is not YAML. Duplicate keys are found here and
    // reported with everything else by parse().
    static Document load(const std::filesystem::path& path);
    static Document from_text(const std::string& text, const std::string& name);

    // Copies are deep. A document that was moved from has no tree.
    Document(const Document& other);
    Document(Document&& other) noexcept;
    Document& operator=(Document other) noexcept;
    ~Document();

    // Accepts earlier names in the document and in later calls of set(); entries apply in their order. `table` must outlive the
    // document. A key that is given by both names is reported by parse().
    void accept(std::span<const Renamed> table);
    // A sentence for each earlier name found, with its place.
    const std::vector<std::string>& notes() const;

    // Applies "a.b.c=value" before parsing; an item of a list is named by its number or its `name`.
    // Missing blocks are made. What does not fit is reported by parse(), at `origin`, or at "--set a.b.c=value".
    void set(const std::string& assignment, const std::string& origin = "");

    const DocumentTree& tree() const { return *tree_; } // changed by set(), gone after an assignment

private:
    explicit Document(std::unique_ptr<DocumentTree> tree);
    std::unique_ptr<DocumentTree> tree_;
};

} // namespace treacle
