"""One page that shows branches and flows offline: diagrams, shapes in three dimensions, profiles, growth rates, rows."""
