//! Static site: pages, tables and figures.
