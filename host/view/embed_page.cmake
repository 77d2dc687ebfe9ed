# cmake -DOUT=file.cpp -DPAGE=folder -DPACKED=plotly.js.gz -P embed_page.cmake: every file of the
# page as text, and the packed script, where there is one, as it is.
file(GLOB sources RELATIVE ${PAGE} ${PAGE}/*)
list(SORT sources)
file(WRITE ${OUT} "#include \"host/view/page_files.h\"\n")
if(PACKED)
  file(APPEND ${OUT} "__asm__(\".pushsection .rodata\\n\"
        \".globl impactdic_plotly_begin\\n.hidden impactdic_plotly_begin\\nimpactdic_plotly_begin:\\n\"
        \".incbin \\\"${PACKED}\\\"\\n\"
        \".globl impactdic_plotly_end\\n.hidden impactdic_plotly_end\\nimpactdic_plotly_end:\\n.byte 0\\n\"
        \".popsection\\n\");
extern \"C\" const char impactdic_plotly_begin[], impactdic_plotly_end[];\n")
endif()
file(APPEND ${OUT} "namespace impactdic::view {
const std::map<std::string, PageFile>& page_files() {
  static const std::map<std::string, PageFile> files = {
")
foreach(source ${sources})
  file(READ ${PAGE}/${source} content)
  file(APPEND ${OUT} "{\"${source}\", {R\"page_file(")
  file(APPEND ${OUT} "${content}")
  file(APPEND ${OUT} ")page_file\", false}},\n")
endforeach()
if(PACKED)
  file(APPEND ${OUT} "{\"plotly.js\", {std::string_view(impactdic_plotly_begin,
      static_cast<std::size_t>(impactdic_plotly_end - impactdic_plotly_begin)), true}},\n")
endif()
file(APPEND ${OUT} "  };\n  return files;\n}\n}  // namespace impactdic::view\n")
