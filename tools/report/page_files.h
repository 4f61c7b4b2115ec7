// The files that report pages are made of.
#pragma once

namespace beampipe {

extern const char* const kPageHtml;  // contains {{css}}, {{d3}}, {{data}}, {{scripts}} and {{title}}
extern const char* const kPageCss;
extern const char* const kPageScripts;  // the scripts in tools/report/page
extern const char* const kD3;           // the library D3 (d3js.org), which draws plots and zooms

}  // namespace beampipe
