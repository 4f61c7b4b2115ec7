// The parts that every report page is made of.
#pragma once

namespace beampipe {

extern const char* const kPageHtml;  // with places for the others: {{css}}, {{d3}}, {{data}}, {{scripts}}, {{title}}
extern const char* const kPageCss;
extern const char* const kPageScripts;  // ours
extern const char* const kD3;           // the library that draws plots and zooms, d3js.org

}  // namespace beampipe
