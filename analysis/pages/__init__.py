"""Reports as one page that stands by itself."""
