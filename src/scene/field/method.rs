//! The words for how a field is moved.

use toml::Spanned;

use super::{FieldSection, Method, VOLUME, word};
use crate::scene::context::Context;
use crate::scene::error::SceneError;
use crate::volume_associated::{AlphaRange, Limiter, PointScheme, Scheme, Smoothing, VolumeMatrix};

/// What scenes that do not say it have: of the library, and of the paper.
const LIMITER: &str = "van_leer";
const SMOOTHING: &str = "local_global";
const MATRIX: &str = "lumped";

const LUMPED: VolumeMatrix = VolumeMatrix::Lumped;

impl FieldSection {
    pub(super) fn method(&mut self, context: Context<'_>) -> Result<Method, SceneError> {
        let direct = PointScheme::Direct { smoothing: Smoothing::default(), matrix: LUMPED };
        let galerkin = PointScheme::LaxWendroffGalerkin { matrix: LUMPED };
        let schemes = [
            ("donor", Method::Faces(Scheme::Donor)),
            ("lax_wendroff", Method::Faces(Scheme::LaxWendroff)),
            ("fct", Method::Faces(Scheme::Fct)),
            ("tvd", Method::Faces(Scheme::Tvd(Limiter::Off))),
            ("muscl", Method::Faces(Scheme::Muscl(Limiter::Off))),
            ("direct", Method::Points(direct)),
            ("lax_wendroff_galerkin", Method::Points(galerkin)),
        ];
        let method = context.word("the scheme", &self.scheme, &schemes)?;
        self.check_keys(method, context)?;
        match method {
            Method::Faces(Scheme::Tvd(_)) => Ok(Method::Faces(Scheme::Tvd(self.limiter(context)?))),
            Method::Faces(Scheme::Muscl(_)) => Ok(Method::Faces(Scheme::Muscl(self.limiter(context)?))),
            Method::Faces(_) => Ok(method),
            Method::Points(PointScheme::Direct { .. }) => {
                let (smoothing, matrix) = (self.smoothing(context)?, self.matrix(context)?);
                Ok(Method::Points(PointScheme::Direct { smoothing, matrix }))
            }
            Method::Points(PointScheme::LaxWendroffGalerkin { .. }) => {
                let matrix = self.matrix(context)?;
                Ok(Method::Points(PointScheme::LaxWendroffGalerkin { matrix }))
            }
        }
    }

    /// Every key has to be of use for the scheme.
    fn check_keys(&self, method: Method, context: Context<'_>) -> Result<(), SceneError> {
        let word = |key: &Option<Spanned<String>>| key.as_ref().map(Spanned::span);
        let scheme = self.scheme.get_ref();
        let is_direct = matches!(method, Method::Points(PointScheme::Direct { .. }));
        let at_points = matches!(method, Method::Points(_));
        let alpha = self.alpha.as_ref().map(Spanned::span);
        let by_mass = (self.weighting.get_ref() != VOLUME).then(|| self.weighting.span());
        let inflow = self.inflow.as_ref().map(Spanned::span);
        let limited = method.limiter().is_some();
        let useless = [
            (word(&self.limiter), limited, "limiter", "\"tvd\" or \"muscl\""),
            (word(&self.smoothing), is_direct, "smoothing", "\"direct\""),
            (alpha, is_direct || limited, "alpha", "\"tvd\", \"muscl\" or \"direct\""),
            (
                word(&self.volume_matrix),
                at_points,
                "volume matrix",
                "\"direct\" or \"lax_wendroff_galerkin\"",
            ),
            (by_mass, !at_points, "mass", "\"muscl\", or any other on face fluxes"),
            (inflow, !at_points, "inflow", "\"muscl\", or any other on face fluxes"),
        ];
        for (place, is_used, what, others) in useless {
            if let Some(place) = place.filter(|_| !is_used) {
                return Err(context.error(
                    place,
                    format!("the scheme \"{scheme}\" has no {what}"),
                    format!("leave it out, or use the scheme {others}"),
                ));
            }
        }
        Ok(())
    }

    fn limiter(&mut self, context: Context<'_>) -> Result<Limiter, SceneError> {
        let word = self.limiter.get_or_insert_with(|| word(LIMITER));
        let known = [
            ("superbee", Limiter::Superbee),
            ("min_mod", Limiter::MinMod),
            ("woodward", Limiter::Woodward),
            ("van_leer", Limiter::VanLeer),
            ("scaled_min_mod", Limiter::ScaledMinMod { alpha: 0.0 }),
            ("courant_min_mod", Limiter::CourantMinMod),
            ("off", Limiter::Off),
        ];
        let limiter = context.word("the limiter", word, &known)?;
        let is_scaled = matches!(limiter, Limiter::ScaledMinMod { .. });
        let alpha = self.alpha(&self.limiter, is_scaled, ["limiter", "scaled_min_mod"], context)?;
        Ok(alpha.map_or(limiter, |alpha| Limiter::ScaledMinMod { alpha }))
    }

    fn smoothing(&mut self, context: Context<'_>) -> Result<Smoothing, SceneError> {
        let word = self.smoothing.get_or_insert_with(|| word(SMOOTHING));
        let with = |local: bool, alpha: f64| (Smoothing { local, alpha }, false);
        let weighted = |local: bool| (Smoothing { local, alpha: 0.0 }, true);
        let known = [
            ("none", with(false, 0.0)),
            ("local", with(true, 0.0)),
            ("global", with(false, 1.0)),
            ("local_global", with(true, 1.0)),
            ("weighted", weighted(false)),
            ("local_weighted", weighted(true)),
        ];
        let (smoothing, is_weighted) = context.word("the smoothing", word, &known)?;
        let alpha = self.alpha(&self.smoothing, is_weighted, ["smoothing", "weighted"], context)?;
        Ok(alpha.map_or(smoothing, |alpha| Smoothing { alpha, ..smoothing }))
    }

    fn matrix(&mut self, context: Context<'_>) -> Result<VolumeMatrix, SceneError> {
        let word = self.volume_matrix.get_or_insert_with(|| word(MATRIX));
        let known = [("lumped", LUMPED), ("consistent", VolumeMatrix::Consistent)];
        context.word("the volume matrix", word, &known)
    }

    /// The factor alpha, where it is wanted: by a word of the key `owner`, such as `example`.
    fn alpha(
        &self,
        owner: &Option<Spanned<String>>,
        is_wanted: bool,
        [what, example]: [&str; 2],
        context: Context<'_>,
    ) -> Result<Option<f64>, SceneError> {
        match (&self.alpha, is_wanted) {
            (None, false) => Ok(None),
            (Some(alpha), true) => {
                AlphaRange::check(*alpha.get_ref()).map_err(|range| {
                    context.error(alpha.span(), range.to_string(), "give a number from 0 to 2")
                })?;
                Ok(Some(*alpha.get_ref()))
            }
            (None, true) => Err(context.error(
                owner.as_ref().map(Spanned::span).unwrap_or_default(),
                format!("this {what} needs its factor alpha"),
                "add alpha = 1.0, or any number from 0 to 2",
            )),
            (Some(alpha), false) => Err(context.error(
                alpha.span(),
                format!("this {what} has no factor alpha"),
                format!("leave it out, or set {what} = \"{example}\""),
            )),
        }
    }
}
